// A robot as groups of meshes that follow its posture.
import {BoxGeometry, Color, CylinderGeometry, DoubleSide, EdgesGeometry, FrontSide, Group, LineSegments, Mesh, MeshLambertMaterial, SphereGeometry, SRGBColorSpace, Vector3} from 'three';

import {bodyPoses, compose, handPose, identityPose, poseFrom} from './kinematics.js';
import {geometryFrom, place, rod, triad, visualGeometry} from './shapes.js';

/// Length of the stretched arm, m.
export function reachOf(robot) {
  const length = robot.tree.reduce((sum, joint) => sum + Math.hypot(...joint.pose.slice(0, 3)), 0);
  return Math.max(0.1, length + Math.hypot(...robot.hand.pose.slice(0, 3)));
}

/// The bodies of a robot as groups that follow its posture.
export class RobotView {
  constructor(robot, materials, options = {}) {
    this.robot = robot;
    this.group = new Group();
    this.bodies = [robot.base, ...robot.bodies].map(body => {
      const group = new Group();
      group.name = body.name;
      this.group.add(group);
      return group;
    });
    this.frames = [];
    this.centroids = [];
    const visuals = robot.visuals?.shapes ?? [];
    const links = new Set(visuals.map(visual => visual.link));
    const drawn = new Set(visuals.map(visual => visual.body));
    for (const visual of visuals) this.addVisual(visual, materials, options);
    for (const shape of robot.shapes) {
      if (!links.has(shape.link)) this.addShape(shape, materials, options);
    }
    if (!options.ghost) this.addJoints(materials, drawn);
    this.addBare(materials, drawn);
  }

  body(index) {
    return this.bodies[index + 1];
  }

  add(index, object, pose) {
    place(object, pose);
    this.body(index).add(object);
  }

  /// A shape of a <visual>, in its own colour where it has one.
  addVisual(visual, materials, options) {
    const mesh = this.robot.visuals.meshes[visual.mesh];
    const side = !mesh || mesh.closed ? FrontSide : DoubleSide;
    const plain = visual.body < 0 ? materials.base : materials.link;
    let material = options.ghost ? materials.ghost : plain;
    if (visual.color && !options.ghost) {
      const color = new Color().setRGB(...visual.color, SRGBColorSpace);
      material = new MeshLambertMaterial({color, side});
    } else if (side === DoubleSide && !options.ghost) {
      material = visual.body < 0 ? materials.openBase : materials.openLink;
    }
    if (visual.geometry) return this.addGeometry(visual, material, materials, options);
    const object = new Mesh(visualGeometry(mesh), material);
    object.scale.set(...visual.scale);
    this.add(visual.body, object, poseFrom(visual.pose));
  }

  addShape(shape, materials, options) {
    const material = options.ghost ? materials.ghost :
        shape.body < 0             ? materials.base :
                                     materials.link;
    this.addGeometry(shape, material, materials, options);
  }

  addGeometry(shape, material, materials, options) {
    const geometry = geometryFrom(shape.geometry);
    this.add(shape.body, new Mesh(geometry, material), poseFrom(shape.pose));
    if (options.ghost || !('box' in shape.geometry || 'convex_mesh' in shape.geometry)) return;
    this.add(
        shape.body, new LineSegments(new EdgesGeometry(geometry, 20), materials.edge),
        poseFrom(shape.pose));
  }

  /// Radius of the round shapes of a body, or a fortieth of the reach.
  radiusOf(index) {
    const radii = this.robot.shapes.filter(shape => shape.body === index)
                      .map(shape => Object.values(shape.geometry)[0].radius ?? 0);
    return Math.max(...radii, 0) || reachOf(this.robot) / 40;
  }

  /// A drum about each joint's axis.
  addJoints(materials, drawn) {
    this.robot.tree.forEach((joint, k) => {
      if (drawn.has(k)) return;
      const r = this.radiusOf(k);
      const drum = joint.slides ?
          new BoxGeometry(2 * r, 2 * r, 2.4 * r) :
          new CylinderGeometry(1.06 * r, 1.06 * r, 2.3 * r, 24).rotateX(Math.PI / 2);
      this.add(k, new Mesh(drum, materials.joint), identityPose());
    });
  }

  /// Links without shapes, and the tool between the last body and the hand frame.
  addBare(materials, drawn) {
    const {robot} = this;
    const hasShape = new Set(robot.shapes.map(shape => shape.body));
    const thin = reachOf(robot) / 90;
    const rodIn = (index, to, material) => {
      const end = new Vector3(...to);
      if (end.length() > 1e-6) this.body(index).add(rod(new Vector3(), end, thin, material));
    };
    robot.tree.forEach(joint => {
      if (joint.parent >= 0 && !hasShape.has(joint.parent) && !drawn.has(joint.parent)) {
        rodIn(joint.parent, joint.pose, materials.link);
      }
    });
    rodIn(robot.hand.body, robot.hand.pose.slice(0, 3), materials.tool);
    const tip = new Group();
    place(tip, poseFrom(robot.hand.pose));
    tip.add(new Mesh(new SphereGeometry(1.6 * thin, 14, 8), materials.tool));
    this.body(robot.hand.body).add(tip);
  }

  /// Axes of base and hand, and of every joint.
  addFrames(size) {
    const frame = (index, pose, scale) => {
      const axes = triad(scale);
      place(axes, pose);
      this.body(index).add(axes);
      this.frames.push(axes);
    };
    frame(-1, identityPose(), 2 * size);
    frame(this.robot.hand.body, poseFrom(this.robot.hand.pose), size);
    this.robot.tree.forEach((joint, k) => frame(k, identityPose(), 0.6 * size));
  }

  addCentroids(materials, size) {
    [this.robot.base, ...this.robot.bodies].forEach((body, i) => {
      const dot = new Mesh(new SphereGeometry(size, 16, 10), materials.centroid);
      dot.position.set(...body.centroid);
      dot.renderOrder = 2;
      this.bodies[i].add(dot);
      this.centroids.push(dot);
    });
  }

  move(state) {
    const poses = bodyPoses(this.robot, state.joints);
    place(this.bodies[0], state.base);
    poses.forEach((pose, k) => place(this.body(k), compose(state.base, pose)));
    this.hand = compose(state.base, handPose(this.robot, poses));
  }
}
