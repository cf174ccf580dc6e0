// The results that the tool writes as JSON beside plans, with their tables.
#pragma once

#include <string>
#include <vector>

#include <stillbase/campaign/campaign.hpp>
#include <stillbase/impact/indices.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/search/trade_off.hpp>
#include <stillbase/simulation/after_contact.hpp>

#include "io/fields/plan.hpp"

namespace stillbase::io {

using Trials = TrialResult;

void trials_fields(Table& t, Trials& trials);
/// @param trials null: none were run
void verification_fields(Table& t, Verification& verification, std::string& content_sha256,
                         Trials* trials);

/// Every matrix of a robot at one state, in B; the paper's letters are the keys.
void inspection_fields(Table& t, const RobotModel& robot, const RobotState& state);

/// One impact by its direction in the xy plane of B, deg from x about z, [0, 360).
struct AnalysisRow {
  double direction_deg = 0;
  ImpactSummary impact;
};

struct AnalysisComparison {
  bool is_illustrative = false;  ///< the resistance's values are not the problem's
  ImpactSummary impact;
};

/// The posture without any particular impulse, under the problem's joint resistance.
struct PostureIndices {
  Ellipsoid impulse;  ///< against a target that cannot be moved
  BaseReactionEllipsoid reaction;
  FavourableDirections favourable_in_plane, favourable_in_space;
  CaseDirections zero_in_plane, zero_in_space;
  GeneralizedJacobianIndices jacobian;
  DynamicCoupling coupling;
};

struct Analysis {
  std::string problem;  ///< its name
  RobotModel robot;
  std::vector<AnalysisRow> rows;
  std::vector<AnalysisComparison> resistances;  ///< in the problem's own direction
  PostureIndices posture;
};
void analysis_fields(Table& t, Analysis& analysis);

/// The motion after the impact under one controller.
struct ControllerRun {
  std::string controller;
  SimulationResult result;
  AfterContact contact;  ///< without its `simulation`, which is `result`
  std::optional<AfterHorizon> after_horizon = {};
};
struct SimulationRuns {
  std::string problem;
  RobotModel robot;
  std::vector<ControllerRun> runs;
};
void simulation_fields(Table& t, SimulationRuns& runs);

/// Contacts that take time beside the instantaneous impact, over their stiffness.
struct ContactTable {
  ResistanceModel resistance = ResistanceModel::Free;
  double restitution = 0, closing_speed = 0, friction = 0;
  std::vector<ModelCheckRow> rows;
};
void contact_table_fields(Table& t, ContactTable& table);

/// A contact feature of the target at one instant.
struct PredictedFeature {
  std::string name;
  Vector3d point = Vector3d::Zero(), normal = Vector3d::Zero(), velocity = Vector3d::Zero();
  double closing_speed = 0;
  std::optional<Eigen::MatrixXd> covariance;  ///< 9 x 9 of point, normal and velocity
};
/// The target at one instant.
struct PredictedInstant {
  TargetState state;
  std::vector<PredictedFeature> features;
};
struct TargetPrediction {
  std::string target;  ///< its name
  std::vector<PredictedInstant> instants;
};
void prediction_fields(Table& t, TargetPrediction& prediction);

void pareto_fields(Table& t, const CaptureProblem& problem, TradeOff& front);

/// Trials of the same plan or problem with the same seed.
struct CampaignGroup {
  CampaignCase piece;
  std::string plan_status = "given";
  bool verified = true;
  Trials trials;
};
void campaign_result_fields(Table& t, MergedCampaign& merged, std::vector<CampaignGroup>& groups);

void best_known_fields(Table& t, BestKnownTable& table);
void bench_fields(Table& t, BenchReferences& references);

}  // namespace stillbase::io
