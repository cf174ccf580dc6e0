/* C interface of stillbase: load robots and problems, evaluate impacts, plan, replan, verify.
 *
 * Handles are opaque; whoever got one frees it. Handles do not change, replanners excepted: any
 * number of threads may use one at once. Numbers are SI and radians. B is the base frame (origin at
 * the centroid of the base body), N the inertial frame; six-vectors have the linear part first;
 * matrices lie row by row; quaternions are [w, x, y, z]. n is the number of joints.
 *
 * No exception leaves a function. Each returns a status; stillbase_error() has the text of the
 * last failure of the calling thread. Outputs are written on STILLBASE_OK alone, unless it says
 * otherwise. Pointers to outputs may be NULL where it says so.
 */
#ifndef STILLBASE_STILLBASE_H
#define STILLBASE_STILLBASE_H

#include <stddef.h>

#if defined(__GNUC__)
#define STILLBASE_API __attribute__((visibility("default")))
#else
#define STILLBASE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct stillbase_robot stillbase_robot;
typedef struct stillbase_problem stillbase_problem;
typedef struct stillbase_plan stillbase_plan;
typedef struct stillbase_replanner stillbase_replanner;

/* Values as the exit codes of the tool. */
typedef enum stillbase_status {
  STILLBASE_OK = 0,
  STILLBASE_INTERNAL_ERROR = 1,
  STILLBASE_WRONG_ARGUMENT = 2, /* NULL, or a number that is not finite or not allowed */
  STILLBASE_INPUT_REFUSED = 3,  /* a file that is missing or wrong: `file:line: rule: message` for
                                   each finding, without a line where it is about none */
  STILLBASE_FILE_FAILED = 7     /* the system did not read or write */
} stillbase_status;

/* Where the robot is at the contact, but for its joints. */
typedef struct stillbase_contact {
  double base_position[3];    /* of B in N, m */
  double base_orientation[4]; /* R_NB, of norm 1 within 1e-6 */
  double contact_time;        /* s */
} stillbase_contact;

/* One impact, in B. */
typedef struct stillbase_impact {
  double impulse[6];     /* [f; t] on the hand, N s, N m s */
  double Delta_Omega[6]; /* velocity jump of the base [v; omega], m/s, rad/s */
  double total[3];       /* change of the angular momentum about the system centroid, N m s */
  double base[3];        /* its part in the base */
  double coupling[3];    /* its part in the arm */
  double closing_speed;  /* m/s */
  char impact_case[3];   /* "G1", "G2", "G3", "C1" or "C2" */
} stillbase_impact;

/* Called as work goes on. @return not zero: stop with the best so far */
typedef int (*stillbase_progress)(const char* what, int done, int total, void* user);

typedef struct stillbase_plan_options {
  double time_limit;           /* s; 0: none. The best so far is the plan, its status "limit"
                                  unless a path was found and judged by then */
  stillbase_progress progress; /* may be NULL; called by one thread at a time, with jobs = 1 by
                                  the calling one alone */
  void* user;                  /* handed to `progress` */
  int jobs;                    /* threads; 0: as many as processors. The plan is the same */
} stillbase_plan_options;

/* "0.1.0" */
STILLBASE_API const char* stillbase_version(void);
/* Text of the last failure of this thread, or of the last plan that stillbase_plan_verify() did not
 * pass, until the next one; "" before the first. */
STILLBASE_API const char* stillbase_error(void);

/* Robots. */

/* Reads a URDF file. hand: name of the hand link; NULL or "": the only link without children. */
STILLBASE_API stillbase_status stillbase_robot_read(const char* path, const char* hand,
                                                    stillbase_robot** robot);
/* NULL is allowed. */
STILLBASE_API void stillbase_robot_free(stillbase_robot* robot);
/* n; 0 for NULL. */
STILLBASE_API int stillbase_robot_joints(const stillbase_robot* robot);
/* Name of joint k, as long as the handle lives; NULL: there is none. */
STILLBASE_API const char* stillbase_robot_joint_name(const stillbase_robot* robot, int k);
/* Velocity jump of free joints for an impulse [f; t] at the hand (6) in B, at joint positions phi
 * (n): Delta_Omega (6), Delta_phidot (n, may be NULL). Numbers so large that these are not finite
 * are refused. */
STILLBASE_API stillbase_status stillbase_robot_jump(const stillbase_robot* robot, const double* phi,
                                                    const double* impulse, double* Delta_Omega,
                                                    double* Delta_phidot);
/* The same at many postures, several at a time: phi (count x n), impulses (count x 6),
 * Delta_Omega (count x 6), base part (count x 3, may be NULL). */
STILLBASE_API stillbase_status stillbase_robot_respond(const stillbase_robot* robot, size_t count,
                                                       const double* phi, const double* impulses,
                                                       double* Delta_Omega, double* base);

/* Problems. */

/* Reads a problem file with the robot and target files that it names. Unlike `stillbase check` it
 * does not look for links that touch in the start posture. */
STILLBASE_API stillbase_status stillbase_problem_read(const char* path,
                                                      stillbase_problem** problem);
/* Reads the text of a problem (YAML or JSON) and of its robot, whose robot.file has to be stated
 * and is not read; the target is stated in place. source: name of the text for messages, one line.
 */
STILLBASE_API stillbase_status stillbase_problem_parse(const char* text, const char* source,
                                                       const char* urdf,
                                                       stillbase_problem** problem);
/* The problem with this contact feature, one of those that it leaves open. */
STILLBASE_API stillbase_status stillbase_problem_at_feature(const stillbase_problem* problem,
                                                            const char* feature,
                                                            stillbase_problem** at);
STILLBASE_API void stillbase_problem_free(stillbase_problem* problem);
STILLBASE_API int stillbase_problem_joints(const stillbase_problem* problem);
/* The start posture phi (n) at the stated base pose and the earliest contact time. */
STILLBASE_API stillbase_status stillbase_problem_start(const stillbase_problem* problem,
                                                       stillbase_contact* contact, double* phi);
/* The nominal impact at phi (n), by the problem's contact law. Delta_phidot (n) may be NULL. Of a
 * problem that leaves the contact feature open, see stillbase_problem_at_feature(). */
STILLBASE_API stillbase_status stillbase_problem_impact(const stillbase_problem* problem,
                                                        const stillbase_contact* contact,
                                                        const double* phi, stillbase_impact* impact,
                                                        double* Delta_phidot);

/* Plans. */

/* Plans a capture, without proofs of what was found. Whatever is not found, it gives a plan: see
 * its status, its samples and stillbase_plan_verify(). options may be NULL. */
STILLBASE_API stillbase_status stillbase_plan_make(const stillbase_problem* problem,
                                                   const stillbase_plan_options* options,
                                                   stillbase_plan** plan);
/* Reads a plan file; one that was changed after it was written is refused. */
STILLBASE_API stillbase_status stillbase_plan_read(const char* path, stillbase_plan** plan);
/* Writes a plan file, whole or not at all. replace 0: an existing file is an error. */
STILLBASE_API stillbase_status stillbase_plan_write(const stillbase_plan* plan, const char* path,
                                                    int replace);
STILLBASE_API void stillbase_plan_free(stillbase_plan* plan);
STILLBASE_API int stillbase_plan_joints(const stillbase_plan* plan);
/* "optimal" (the best candidate, a minimum), "feasible" and "infeasible" are of the search and say
 * nothing of the path and of the limits after the impact; "limit": a stop came before the search
 * had ended, a path was found and the time after the impact was judged. NULL for NULL. */
STILLBASE_API const char* stillbase_plan_status(const stillbase_plan* plan);
/* Name of the chosen contact feature, as long as the handle lives; "" without features, NULL for
 * NULL. */
STILLBASE_API const char* stillbase_plan_feature(const stillbase_plan* plan);
/* Text of the plan file, as long as the handle lives. */
STILLBASE_API const char* stillbase_plan_json(const stillbase_plan* plan);
/* The chosen configuration with phi (n), and the nominal impact there; Delta_phidot (n), impact
 * and contact may be NULL. */
STILLBASE_API stillbase_status stillbase_plan_choice(const stillbase_plan* plan,
                                                     stillbase_contact* contact, double* phi,
                                                     stillbase_impact* impact,
                                                     double* Delta_phidot);
/* Samples of the approach path; 0: there is none. */
STILLBASE_API size_t stillbase_plan_samples(const stillbase_plan* plan);
/* Times (k), joint positions (k x n), joint velocities (k x n, may be NULL) of k samples; between
 * them the joints follow cubic Hermite segments. The last time is the contact time. */
STILLBASE_API stillbase_status stillbase_plan_path(const stillbase_plan* plan, double* times,
                                                   double* joint_positions,
                                                   double* joint_velocities);
/* Recomputes a plan by other code than the planner's, path and limits after the impact included.
 * passes: 1 or 0; on 0 stillbase_error() names the checks that fail. */
STILLBASE_API stillbase_status stillbase_plan_verify(const stillbase_plan* plan, int* passes);

/* Replanning: joints, base pose and time of the contact follow an estimate of the target that
 * moves. The approach path does not: it has to be planned again to the new contact. */

/* An estimate of the target, in N. */
typedef struct stillbase_estimate {
  double time;                /* s */
  double position[3];         /* of the centroid, m */
  double orientation[4];      /* R_NT */
  double linear_velocity[3];  /* of the centroid, m/s */
  double angular_velocity[3]; /* rad/s */
  /* 12 x 12, of position, orientation (rotation vector in the target's axes), linear and angular
   * velocity, symmetric and positive semidefinite; NULL: as well known as before */
  const double* covariance;
} stillbase_estimate;

/* What an update found. Values are in the unit of the problem's objective. */
typedef struct stillbase_update {
  /* "optimal", "feasible", "infeasible" or "refused": an estimate that cannot be used, which
   * changes nothing */
  const char* status;
  const char* reason;       /* of "refused", else "" */
  int was_cut;              /* 1: the deadline came before the descent had ended */
  double value;             /* of the measure that is minimised */
  double nominal;           /* at the nominal direction */
  double worst_case;        /* over the cone */
  double max_violation;     /* of the constraints, in their units; feasible: at most 1e-9 */
  double least_margin;      /* of the inequalities, in their units; negative: violated */
  double kkt_residual;      /* HUGE_VAL: not known */
  double old_value;         /* of the old posture under the new estimate */
  double old_max_violation; /* above 1e-9 the old posture is not feasible under it */
  double seconds;
} stillbase_update;

/* Sets up from a plan and its problem, with memory for all updates. Problems that it does not cover
 * are refused with the reason.
 * stay_within: rad (m) that each joint may be from the plan's as long as a posture there satisfies
 * the constraints, > 0; 0.1 keeps most of what was judged of the plan alone, HUGE_VAL: anywhere. */
STILLBASE_API stillbase_status stillbase_replanner_make(const stillbase_plan* plan,
                                                        double stay_within,
                                                        stillbase_replanner** replanner);
STILLBASE_API void stillbase_replanner_free(stillbase_replanner* replanner);
/* n; 0 for NULL. */
STILLBASE_API int stillbase_replanner_joints(const stillbase_replanner* replanner);
/* The best contact that is found in time for the estimate, never worse than a feasible old one. No
 * memory is allocated on robots of up to 20 joints. One thread at a time.
 * deadline: s from now; 0: now, HUGE_VAL: none. phi (n); contact and update may be NULL. */
STILLBASE_API stillbase_status stillbase_replanner_update(stillbase_replanner* replanner,
                                                          const stillbase_estimate* estimate,
                                                          double deadline,
                                                          stillbase_contact* contact, double* phi,
                                                          stillbase_update* update);

#ifdef __cplusplus
}
#endif

#endif
