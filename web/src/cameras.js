// Where a view stands: the frame that is at rest on the screen (x to the right, z up, looked at
// along y), and the distance from which everything is in the picture. There is no up in space: the
// arm lies across the screen.
import {Matrix4, Quaternion, Vector3} from 'three';

import {apply, compose, inverse} from './kinematics.js';

export const kCameras = {
  free: 'Free',
  base: 'Base',
  hand: 'Hand',
  normal: 'Along the normal'
};

/// Axes with x along one direction and z as near to another as it can be.
function basis(x, nearZ) {
  const right = x.clone().normalize();
  const up = nearZ.clone().addScaledVector(right, -nearZ.dot(right));
  if (up.length() < 0.3 * nearZ.length()) {
    const other = new Vector3(nearZ.y, nearZ.z, nearZ.x);
    up.copy(other).addScaledVector(right, -other.dot(right));
  }
  up.normalize();
  const axes = new Matrix4().makeBasis(right, up.clone().cross(right), up);
  return new Quaternion().setFromRotationMatrix(axes);
}

const turned = quaternion => ({position: new Vector3(), quaternion});

/// Where the arm bows out from the straight line between base and hand: shown upwards, it hides
/// least.
function bow(contact, bodies) {
  const line = contact.hand.position.clone().sub(contact.base.position).normalize();
  const sum = new Vector3();
  for (const {position} of bodies) {
    const arm = position.clone().sub(contact.base.position);
    sum.add(arm.addScaledVector(line, -arm.dot(line)));
  }
  return sum.length() > 1e-3 * bodies.length ? sum.normalize() : new Vector3(0, 0, 1);
}

/// @param contact {base, hand, target} poses at the contact; target may be null
/// @param bodies poses of the arm's bodies at the contact
/// @param feature of the target, or null
/// @param planar whether all joints turn about the inertial z axis
/// @return name -> function of the poses now to the pose of the view's frame
export function viewFrames(contact, bodies, feature, planar) {
  const goal =
      contact.target && feature ? apply(contact.target, feature.point) : contact.hand.position;
  const along = goal.clone().sub(contact.base.position);
  if (along.length() < 1e-6) along.set(1, 0, 0);
  const z = new Vector3(0, 0, 1);
  const inertial =
      planar ? basis(along, z.clone().cross(along)) : basis(along, bow(contact, bodies));
  const inBase = contact.base.quaternion.clone().invert().multiply(inertial);
  const frames = {
    free: () => turned(inertial),
    base: now => compose(now.base, turned(inBase)),
  };
  const normal = contact.target && feature ?
      new Vector3(...feature.normal).applyQuaternion(contact.target.quaternion) :
      null;
  const up = new Vector3(0, 0, 1).applyQuaternion(inertial);
  const pointing = normal ? normal.clone().negate() : along;
  const inHand = contact.hand.quaternion.clone().invert().multiply(basis(pointing, up));
  frames.hand = now => compose(now.hand, turned(inHand));
  if (normal) {
    // Looked at along minus the normal: y = -n, so x = y cross z.
    const axes = basis(normal.clone().negate().cross(up), up);
    const inTarget = contact.target.quaternion.clone().invert().multiply(axes);
    const point = new Vector3(...feature.point);
    frames.normal = now => compose(now.target, {position: point, quaternion: inTarget});
  }
  return frames;
}

/// From where the view's frame is looked at.
export function viewDirection(name, planar) {
  if (name === 'normal') return new Vector3(-0.5, -1, 0.45).normalize();
  if (name === 'hand') return new Vector3(-0.55, -1, 0.45).normalize();
  return (planar ? new Vector3(0, -1, -0.35) : new Vector3(0.16, -1, 0.34)).normalize();
}

/// The least distance from a center from which all spheres [point, radius] are in the picture.
/// @return {center, distance}
export function fit(spheres, from, camera) {
  const right = new Vector3(0, 0, 1).cross(from).normalize();
  const above = from.clone().cross(right);
  const middle = axis => {
    const low = Math.min(...spheres.map(([point, radius]) => point.dot(axis) - radius));
    const high = Math.max(...spheres.map(([point, radius]) => point.dot(axis) + radius));
    return (low + high) / 2;
  };
  const center = new Vector3();
  for (const axis of [right, above, from]) center.addScaledVector(axis, middle(axis));
  const tangent = Math.tan(camera.fov * Math.PI / 360);
  const room = 1.05;  // about the outermost sphere
  const distance = Math.max(...spheres.map(([point, radius]) => {
    const local = point.clone().sub(center);
    const across = (Math.abs(local.dot(right)) + radius) / camera.aspect;
    return local.dot(from) + room * Math.max(across, Math.abs(local.dot(above)) + radius) / tangent;
  }));
  return {center, distance};
}

/// Points in the view's frame.
export const inView = (frame, point) => apply(inverse(frame), point.toArray());
