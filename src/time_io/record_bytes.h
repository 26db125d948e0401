// Records as columns of numbers.
#pragma once

#include "film/record_tile.h"
#include "time_io/columns.h"
#include "time_io/tile_bytes.h"

namespace kairos {

uint64_t raw_record_bytes(const TileCounts& counts);
void write_records(ColumnWriter& out, const RecordTile& tile);
/// meshes: how many there are in the scene; 0: nobody knows. Throws NoTile for what no rendering hands over.
RecordTile read_records(ColumnReader& in, const TileCounts& counts, size_t meshes);

}  // namespace kairos
