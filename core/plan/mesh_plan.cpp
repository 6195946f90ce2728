#include "core/plan/mesh_plan.h"

#include <utility>

namespace tet {

MeshPlan::MeshPlan(MeshFacts facts) : facts_(std::move(facts)) {}

MeshPlan::~MeshPlan() = default;

}  // namespace tet
