/* The C interface from a C program: errors, an impact, a plan, its path, its verification, an
 * update. Usage: plan_a_capture SOURCE_FOLDER. Ends with 0 when all of it is as it must be. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <stillbase/stillbase.h>

static int failures = 0;

static void check(int holds, const char* what) {
  if (holds) return;
  printf("does not hold: %s (%s)\n", what, stillbase_error());
  ++failures;
}

static int count_steps(const char* what, int done, int total, void* user) {
  (void)what;
  if (done < 0 || done > total) ++failures;
  ++*(int*)user;
  return 0;
}

static int stop_at_once(const char* what, int done, int total, void* user) {
  (void)what, (void)done, (void)total, (void)user;
  return 1;
}

static void refuse_wrong_input(const char* problem_path) {
  stillbase_robot* robot = NULL;
  stillbase_problem* problem = NULL;
  stillbase_plan* plan = NULL;
  check(stillbase_robot_read(NULL, NULL, &robot) == STILLBASE_WRONG_ARGUMENT, "NULL is refused");
  check(strcmp(stillbase_error(), "path: is NULL") == 0, "the error names the argument");
  check(stillbase_problem_parse("format: stillbase.problem\nversion: 1\nrobott: 1\n", "text", "",
                                &problem) == STILLBASE_INPUT_REFUSED,
        "an unknown key is refused");
  check(strstr(stillbase_error(), "text:3: unknown-key: ") != NULL, "the error has file and line");
  check(stillbase_plan_read(problem_path, &plan) == STILLBASE_INPUT_REFUSED,
        "a problem is no plan");
  check(robot == NULL && problem == NULL && plan == NULL, "failures make no handles");
  stillbase_robot_free(NULL);
  stillbase_problem_free(NULL);
  stillbase_plan_free(NULL);
}

static void evaluate(const char* robot_path) {
  stillbase_robot* robot = NULL;
  /* The paper's two-link arm, reading A, at (-80, 160) deg, hit along 30 deg: 67.9638 N s. */
  const double phi[2] = {-80 * 3.14159265358979323846 / 180, 160 * 3.14159265358979323846 / 180};
  const double p = 67.9638, angle = 30 * 3.14159265358979323846 / 180;
  double impulse[6] = {0}, jump[6], rates[2], many[12], base[6], phis[4], impulses[12];
  int i;
  impulse[0] = p * cos(angle);
  impulse[1] = p * sin(angle);
  check(stillbase_robot_read(robot_path, "hand", &robot) == STILLBASE_OK, "the robot is read");
  check(stillbase_robot_joints(robot) == 2, "it has two joints");
  check(strcmp(stillbase_robot_joint_name(robot, 1), "joint_2") == 0, "they have names");
  check(stillbase_robot_joint_name(robot, 2) == NULL, "there is no third");
  check(stillbase_robot_jump(robot, phi, impulse, jump, rates) == STILLBASE_OK, "the jump");
  check(fabs(jump[5] - 0.073547) < 1e-6, "base rate of the paper's example");
  check(fabs(hypot(rates[0], rates[1]) - 0.863540) < 1e-6, "joint rates of the paper's example");
  for (i = 0; i < 4; ++i) phis[i] = phi[i % 2];
  for (i = 0; i < 12; ++i) impulses[i] = impulse[i % 6];
  check(stillbase_robot_respond(robot, 2, phis, impulses, many, base) == STILLBASE_OK, "postures");
  for (i = 0; i < 12; ++i) check(fabs(many[i] - jump[i % 6]) < 1e-12, "one by one or together");
  check(fabs(base[5] - 96.0832) < 1e-3, "base part of the momentum");
  check(stillbase_robot_respond(robot, (size_t)-1, phis, impulses, many, NULL) ==
            STILLBASE_WRONG_ARGUMENT,
        "more postures than memory are refused");
  impulses[0] = 1e308;
  impulses[1] = 1e308;
  check(stillbase_robot_respond(robot, 2, phis, impulses, many, NULL) == STILLBASE_WRONG_ARGUMENT,
        "an answer that is not finite is refused");
  check(stillbase_robot_jump(robot, phi, impulses, jump, NULL) == STILLBASE_WRONG_ARGUMENT,
        "of one posture too");
  check(strcmp(stillbase_error(), "the numbers are so large that the answer is not finite") == 0,
        "in words");
  phis[3] = NAN;
  check(stillbase_robot_respond(robot, 2, phis, impulses, many, NULL) == STILLBASE_WRONG_ARGUMENT,
        "NaN is refused");
  check(strcmp(stillbase_error(), "phi: number 3 is not finite") == 0, "with its place");
  stillbase_robot_free(robot);
}

/* 1 once a path would be looked for: the search is complete then. */
static int stop_after_search(const char* what, int done, int total, void* user) {
  (void)done;
  (void)total;
  (void)user;
  return strcmp(what, "after the impact") == 0;
}

static void choose_a_feature(const char* several_path, const char* one_path) {
  stillbase_problem *several = NULL, *one = NULL, *other = NULL;
  stillbase_plan* plan = NULL;
  stillbase_contact contact;
  stillbase_impact impact;
  double phi[16];
  check(stillbase_problem_read(several_path, &several) == STILLBASE_OK, "an open feature is read");
  check(stillbase_problem_start(several, &contact, phi) == STILLBASE_OK, "its start");
  check(stillbase_problem_impact(several, &contact, phi, &impact, NULL) == STILLBASE_WRONG_ARGUMENT,
        "an impact needs a feature");
  check(stillbase_problem_at_feature(several, "nose", &one) == STILLBASE_WRONG_ARGUMENT,
        "which the target has");
  check(strstr(stillbase_error(),
               "feature: 'nose' is not one of the problem's, [upper_edge, lower_edge]") != NULL,
        "in words");
  check(stillbase_problem_at_feature(several, "lower_edge", &one) == STILLBASE_OK, "one of them");
  check(stillbase_problem_impact(one, &contact, phi, &impact, NULL) == STILLBASE_OK, "its impact");
  stillbase_problem_free(one);
  stillbase_problem_free(several);
  check(stillbase_problem_read(one_path, &other) == STILLBASE_OK, "a stated feature");
  {
    stillbase_plan_options options = {0, stop_after_search, NULL, 1};
    check(stillbase_plan_make(other, &options, &plan) == STILLBASE_OK, "a plan without path");
  }
  check(strcmp(stillbase_plan_feature(plan), "plus_x") == 0, "names it");
  check(stillbase_plan_samples(plan) == 0, "has no samples");
  check(strcmp(stillbase_plan_status(plan), "limit") == 0, "is not complete");
  stillbase_plan_free(plan);
  stillbase_problem_free(other);
}

static void plan_and_verify(const char* problem_path, const char* plan_path) {
  stillbase_problem* problem = NULL;
  stillbase_plan *plan = NULL, *read = NULL, *stopped = NULL;
  stillbase_contact contact;
  stillbase_impact at_plan, again;
  double phi[2], times[2000], path[4000];
  int steps = 0, passes = 0;
  stillbase_plan_options options = {0, count_steps, NULL, 2};
  options.user = &steps;
  check(stillbase_problem_read(problem_path, &problem) == STILLBASE_OK, "the problem is read");
  check(stillbase_problem_start(problem, &contact, phi) == STILLBASE_OK, "start configuration");
  check(fabs(phi[0] + 80 * 3.14159265358979323846 / 180) < 1e-12, "the start posture");
  check(stillbase_plan_make(problem, &options, &plan) == STILLBASE_OK, "the plan");
  check(steps > 0, "progress is told");
  check(strcmp(stillbase_plan_status(plan), "optimal") == 0, "it is optimal");
  check(stillbase_plan_choice(plan, &contact, phi, &at_plan, NULL) == STILLBASE_OK, "its choice");
  check(strcmp(at_plan.impact_case, "C2") == 0, "case C2");
  check(stillbase_problem_impact(problem, &contact, phi, &again, NULL) == STILLBASE_OK, "impact");
  check(fabs(again.impulse[0] - at_plan.impulse[0]) < 1e-9, "the same impulse");
  check(stillbase_plan_samples(plan) > 1 && stillbase_plan_samples(plan) <= 2000, "path samples");
  check(stillbase_plan_path(plan, times, path, NULL) == STILLBASE_OK, "the path");
  check(fabs(path[2 * stillbase_plan_samples(plan) - 1] - phi[1]) < 1e-9, "it ends at the choice");
  check(stillbase_plan_verify(plan, &passes) == STILLBASE_OK && passes == 1, "it is verified");
  check(stillbase_plan_write(plan, plan_path, 1) == STILLBASE_OK, "it is written");
  check(stillbase_plan_write(plan, plan_path, 0) == STILLBASE_FILE_FAILED, "and not replaced");
  check(stillbase_plan_read(plan_path, &read) == STILLBASE_OK, "it is read");
  check(strcmp(stillbase_plan_json(read), stillbase_plan_json(plan)) == 0, "the same text");
  options.progress = stop_at_once;
  check(stillbase_plan_make(problem, &options, &stopped) == STILLBASE_OK, "a stopped search");
  check(strcmp(stillbase_plan_status(stopped), "optimal") != 0, "says so");
  stillbase_plan_free(stopped);
  stillbase_plan_free(read);
  stillbase_plan_free(plan);
  stillbase_problem_free(problem);
}

static void replan(const char* problem_path, const char* stated_direction) {
  stillbase_problem* problem = NULL;
  stillbase_plan* plan = NULL;
  stillbase_replanner* replanner = NULL;
  stillbase_contact contact;
  stillbase_update update;
  stillbase_estimate estimate = {0,   {5.9, 0.42, -0.06}, {0, 0, 0, 1}, {-0.05, 0, 0}, {0, 0, 0},
                                 NULL};
  double phi[3], planned[3], covariance[144] = {0};
  int k;
  estimate.angular_velocity[2] = 5 * 3.14159265358979323846 / 180;
  check(stillbase_problem_read(problem_path, &problem) == STILLBASE_OK, "a client's problem");
  check(stillbase_plan_make(problem, NULL, &plan) == STILLBASE_OK, "its plan");
  check(stillbase_replanner_make(NULL, 0.1, &replanner) == STILLBASE_WRONG_ARGUMENT,
        "NULL is no plan");
  check(stillbase_replanner_make(plan, 0, &replanner) == STILLBASE_WRONG_ARGUMENT,
        "nowhere is no place to stay");
  check(stillbase_replanner_make(plan, 0.1, &replanner) == STILLBASE_OK, "a replanner");
  check(stillbase_replanner_joints(replanner) == 3, "of three joints");
  check(stillbase_plan_choice(plan, &contact, planned, NULL, NULL) == STILLBASE_OK, "the choice");
  check(stillbase_replanner_update(replanner, &estimate, HUGE_VAL, &contact, phi, &update) ==
            STILLBASE_OK,
        "an update with the problem's own estimate");
  check(strcmp(update.status, "optimal") == 0, "is optimal");
  for (k = 0; k < 3; ++k) check(fabs(phi[k] - planned[k]) < 1e-6, "and keeps the posture");
  for (k = 0; k < 12; ++k) covariance[13 * k] = 1e-8;
  estimate.covariance = covariance;
  estimate.position[1] += 0.01;
  estimate.angular_velocity[2] *= 1.002;
  check(stillbase_replanner_update(replanner, &estimate, 0.01, &contact, phi, &update) ==
            STILLBASE_OK,
        "an update within 10 ms");
  check(strcmp(update.status, "optimal") == 0 || update.was_cut, "is optimal, or says why not");
  check(update.max_violation <= 1e-9 && update.least_margin > -1e-9, "is feasible");
  check(update.old_max_violation > 1e-9 || update.value <= update.old_value, "is never worse");
  check(contact.contact_time >= 70 && contact.contact_time <= 74, "has a time in the window");
  check(stillbase_replanner_update(replanner, &estimate, 0, NULL, phi, &update) == STILLBASE_OK &&
            update.was_cut,
        "no time is left at all");
  covariance[1] = 1e-8;
  check(stillbase_replanner_update(replanner, &estimate, HUGE_VAL, NULL, phi, &update) ==
                STILLBASE_OK &&
            strcmp(update.status, "refused") == 0 && strstr(update.reason, "symmetric") != NULL,
        "what is no covariance is refused");
  covariance[1] = 0;
  estimate.time = NAN;
  check(stillbase_replanner_update(replanner, &estimate, HUGE_VAL, NULL, phi, &update) ==
                STILLBASE_OK &&
            strcmp(update.status, "refused") == 0,
        "NaN is refused");
  check(strcmp(update.reason, "a number is not finite") == 0, "with the reason");
  check(stillbase_replanner_update(replanner, &estimate, -1, NULL, phi, NULL) ==
            STILLBASE_WRONG_ARGUMENT,
        "a deadline before now is wrong");
  stillbase_replanner_free(replanner);
  stillbase_plan_free(plan);
  stillbase_problem_free(problem);
  replanner = NULL;
  check(stillbase_problem_read(stated_direction, &problem) == STILLBASE_OK, "a stated direction");
  check(stillbase_plan_make(problem, NULL, &plan) == STILLBASE_OK, "its plan");
  check(stillbase_replanner_make(plan, HUGE_VAL, &replanner) == STILLBASE_INPUT_REFUSED,
        "is not replanned");
  check(strstr(stillbase_error(), "not-replannable: impact.direction") != NULL, "with the reason");
  stillbase_replanner_free(NULL);
  stillbase_plan_free(plan);
  stillbase_problem_free(problem);
}

int main(int argc, char** argv) {
  char problem[4096], robot[4096], client[4096], several[4096];
  if (argc != 3) return 2;
  snprintf(problem, sizeof problem, "%s/problems/planar_two_link_c2_a.yaml", argv[1]);
  snprintf(robot, sizeof robot, "%s/problems/robots/planar_two_link_a.urdf", argv[1]);
  snprintf(client, sizeof client, "%s/problems/planar_three_link_client.yaml", argv[1]);
  refuse_wrong_input(problem);
  snprintf(several, sizeof several, "%s/problems/deos_features.yaml", argv[1]);
  evaluate(robot);
  plan_and_verify(problem, argv[2]);
  replan(client, problem);
  choose_a_feature(several, client);
  printf("stillbase %s, %d failures\n", stillbase_version(), failures);
  return failures == 0 ? 0 : 1;
}
