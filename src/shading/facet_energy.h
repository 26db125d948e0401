// What rough facets send away after one reflection or refraction, and what they keep for further ones.
#pragma once

namespace kairos {

/// The share, in (0, 1], of light from a direction that facets of GGX reflect once and away, if each reflects all that
/// falls on it: the rest falls on other facets. cosine: of the direction and the normal; alpha: of highlight_lobe();
/// both 0 to 1. Looked up in a table that the first call computes; to within 0.003.
double reflected_once(double cosine, double alpha);

/// The same of clear glass, whose facets reflect some of it and refract the rest. eta: refractive index ahead over that
/// behind, of which a third to 3 is told apart. To within 0.005.
double reflected_or_refracted_once(double cosine, double alpha, double eta);

/// By how much to multiply what facets send away once, so that it stands for all: what goes from facet to facet leaves
/// about where the rest does (E. Turquin 2019). reflectance: of each time, 0 to 1.
inline double all_reflections(double once, double reflectance) { return 1 + reflectance * (1 - once) / once; }

}  // namespace kairos
