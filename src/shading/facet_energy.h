// What rough facets that reflect all light send back after one reflection, and what they keep for further ones.
#pragma once

namespace kairos {

/// The share, in (0, 1], of light from a direction that facets of GGX reflect once and away, if each reflects all that
/// falls on it: the rest falls on other facets. cosine: of the direction and the normal; alpha: of highlight_lobe();
/// both 0 to 1. Looked up in a table that the first call computes; to within 0.003.
double reflected_once(double cosine, double alpha);

/// By how much to multiply what facets reflect once, so that it stands for all reflections: what goes from facet to
/// facet leaves about where single reflections do (E. Turquin 2019). reflectance: at normal incidence, 0 to 1.
inline double all_reflections(double once, double reflectance) { return 1 + reflectance * (1 - once) / once; }

}  // namespace kairos
