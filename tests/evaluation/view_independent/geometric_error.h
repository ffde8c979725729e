// How much of the surface's shape is lost while a node is not split: what the view-independent way
// orders by. Computed from the full mesh, without any view.
//
// Each leaf has the quadric of its triangles (Garland and Heckbert 1997): the squared distance to
// their planes, weighted by a third of their areas; and the sum of their areas and area normals. A
// node has the sums of the leaves below it.
//  - distance: the quadric at the place where the node's vertex stands, grid steps^4. What
//    simplification goes by.
//  - normal: area times the variance of the normals below the node (the L2,1 metric of
//    Cohen-Steiner, Alliez and Desbrun, Variational shape approximation, SIGGRAPH 2004), grid
//    steps^2: closer to what shading shows.
//  - both: their geometric mean.
#pragma once

#include <vector>

#include "tests/evaluation/view_independent/pack_records.h"

namespace meshfront::evaluation {

enum class ErrorMeasure { distance, normal, both };

// By record, >= 0. `full`: all records applied.
[[nodiscard]] std::vector<double> geometricErrors(const RefinedPack& full, ErrorMeasure measure);

}  // namespace meshfront::evaluation
