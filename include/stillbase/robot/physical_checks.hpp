// What a mass, an inertia tensor or a hull must satisfy to belong to a real rigid body.
#pragma once

#include <string>

#include <stillbase/core/types.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

/// Why no rigid body can have this inertia tensor; empty when one can.
///
/// Asked for: finite, symmetric, positive definite, and no principal moment larger than the sum of
/// the other two (each is an integral of squared distances from an axis). The message names the
/// principal moments. Flat bodies, where the larger moment equals the sum, pass: the sum may be
/// missed by 1e-5 of it, which is what six written digits can lose.
/// @param inertia about the centroid, kg m^2
/// @param rounding kg m^2; the sum may be missed by this, too, where fewer digits were written, but
/// by no more than 0.05 of the largest moment
/// @param may_be_thin principal moments of zero pass: those of a rod without thickness and of a
/// point mass
std::string inertia_fault(const Matrix3d& inertia, double rounding = 0, bool may_be_thin = false);

/// Why no rigid body can have this mass (kg); empty when one can: finite and > 0.
std::string mass_fault(double mass);

/// Why this is no convex mesh; empty when it is: at least 4 vertices and 4 faces, every face a
/// polygon of the vertices, no vertex outside of a face by more than 1e-6 of the mesh's size.
std::string convex_mesh_fault(const ConvexMesh& mesh);

}  // namespace stillbase
