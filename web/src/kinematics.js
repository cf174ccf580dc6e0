// Poses of a robot's bodies from its chain and joint positions, as src/dynamics/kinematics.cpp.
import {Quaternion, Vector3} from 'three';

const kZ = new Vector3(0, 0, 1);

/// [x, y, z, qw, qx, qy, qz] as position and rotation.
export function poseFrom(list) {
  return {
    position: new Vector3(list[0], list[1], list[2]),
    quaternion: new Quaternion(list[4], list[5], list[6], list[3]),
  };
}

export const identityPose = () => ({position: new Vector3(), quaternion: new Quaternion()});

/// T_AC = T_AB * T_BC.
export function compose(ab, bc) {
  return {
    position: bc.position.clone().applyQuaternion(ab.quaternion).add(ab.position),
    quaternion: ab.quaternion.clone().multiply(bc.quaternion),
  };
}

export function inverse(pose) {
  const quaternion = pose.quaternion.clone().invert();
  return {position: pose.position.clone().negate().applyQuaternion(quaternion), quaternion};
}

export const apply = (pose, point) =>
    new Vector3(...point).applyQuaternion(pose.quaternion).add(pose.position);

/// T_BA between 0 (the first) and 1 (the second): straight line, constant rate of rotation.
export function between(first, second, part) {
  return {
    position: first.position.clone().lerp(second.position, part),
    quaternion: first.quaternion.clone().slerp(second.quaternion, part),
  };
}

/// Poses T_Bk of all bodies in the base frame: T_Bparent * joint frame * joint(position), where
/// the position is ratio * phi[joint] + offset.
export function bodyPoses(robot, joints) {
  const poses = [];
  for (const {parent, pose, slides, joint, ratio = 1, offset = 0} of robot.tree) {
    const position = ratio * joints[joint] + offset;
    const moved = identityPose();
    if (slides) {
      moved.position.set(0, 0, position);
    } else {
      moved.quaternion.setFromAxisAngle(kZ, position);
    }
    const above = parent < 0 ? identityPose() : poses[parent];
    poses.push(compose(compose(above, poseFrom(pose)), moved));
  }
  return poses;
}

/// Pose of the hand in the base frame.
export function handPose(robot, poses) {
  const body = robot.hand.body < 0 ? identityPose() : poses[robot.hand.body];
  return compose(body, poseFrom(robot.hand.pose));
}
