// Slabs of time, which were recorded one after the other, as one.
#pragma once

#include <memory>
#include <span>

#include "film/object_tile.h"
#include "film/time_tile.h"

namespace kairos {

/// What the same square of `pixels` pixels shows in equal parts of the time, one after the other, as what it shows in
/// all of it. Null: nothing is known of a part; it is black, and nothing is seen of meshes. All parts are exact, or
/// none is. Without deviations.
TimeTile join_slabs(std::span<const std::shared_ptr<const TimeTile>> slabs, size_t pixels);
ObjectTile join_slabs(std::span<const std::shared_ptr<const ObjectTile>> slabs, size_t pixels);

}  // namespace kairos
