// Recorded streams of estimates of a target, as CSV.
//
// First line: names of the columns, in any order, with their units. Needed:
//   time_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s
// position and velocity of the centroid in N, R_NT as a unit quaternion, angular velocity in N: as
// the target's lines of `stillbase predict -o FILE.csv`. How well that is known, one of
//   standard deviations of independent errors, all twelve:
//     sd_x_m,sd_y_m,sd_z_m,sd_rx_rad,sd_ry_rad,sd_rz_rad,
//     sd_vx_m_s,sd_vy_m_s,sd_vz_m_s,sd_wx_rad_s,sd_wy_rad_s,sd_wz_rad_s
//   the upper triangle of the covariance, 78 columns cov_A_B, A and B of
//     x y z rx ry rz vx vy vz wx wy wz in this order, in m, rad, m/s, rad/s:
//     cov_x_x,cov_x_y,...,cov_wz_wz
// with rotation vectors in T, everything else in N. Or neither. One line per estimate, times
// rising. Lines that begin with # and empty lines are skipped.
#pragma once

#include <string>
#include <vector>

#include <stillbase/target/estimate.hpp>

namespace stillbase {

/// @throws InputError with line and column of each finding
/// @throws FileError
std::vector<StateEstimate> read_estimates(const std::string& path);
/// The same from a text. @param source its name for messages
std::vector<StateEstimate> read_estimates_text(const std::string& text, const std::string& source);

}  // namespace stillbase
