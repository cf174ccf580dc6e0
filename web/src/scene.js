// The scene: robot, target, feature, impulse, and what is drawn of their motion. World is the
// inertial frame, z up.
import {AmbientLight, ArrowHelper, BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CatmullRomCurve3, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, EdgesGeometry, Group, HemisphereLight, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Quaternion, RingGeometry, Scene as ThreeScene, SphereGeometry, TubeGeometry, Vector3, WebGLRenderer,} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';

import {apply, bodyPoses, compose, handPose, identityPose, inverse, poseFrom} from './kinematics.js';

const kY = new Vector3(0, 1, 0);
const kZ = new Vector3(0, 0, 1);

const kPalettes = {
  light: {
    base: '#f4f3ef',
    link: '#c9d1d8',
    joint: '#56646f',
    tool: '#2f3a44',
    target: '#d6b567',
    feature: '#b4451f',
    normal: '#b4451f',
    impulse: '#c8321e',
    trace: '#2563a8',
    targetTrace: '#a37c1c',
    obstacle: '#8d8f94',
    ghost: '#2563a8',
    edge: '#39434c',
    close: '#c8321e',
    sky: '#ffffff',
    ground: '#9aa4ad',
  },
  dark: {
    base: '#d9d8d3',
    link: '#98a5b1',
    joint: '#4c5964',
    tool: '#1d242b',
    target: '#c09c4b',
    feature: '#f0734a',
    normal: '#f0734a',
    impulse: '#ff6a4d',
    trace: '#6aa7e8',
    targetTrace: '#d8b65c',
    obstacle: '#74777d',
    ghost: '#6aa7e8',
    edge: '#0b0e11',
    close: '#ff6a4d',
    sky: '#dfe9f2',
    ground: '#2b333b',
  },
};

/// A geometry of a file: cylinder and capsule along z, all centred.
function geometryFrom(geometry) {
  const [kind, size] = Object.entries(geometry)[0];
  if (kind === 'box') return new BoxGeometry(...size.size);
  if (kind === 'sphere') return new SphereGeometry(size.radius, 24, 14);
  if (kind === 'cylinder') {
    return new CylinderGeometry(size.radius, size.radius, size.length, 24).rotateX(Math.PI / 2);
  }
  if (kind === 'capsule') {
    return new CapsuleGeometry(size.radius, size.length, 5, 20).rotateX(Math.PI / 2);
  }
  const triangles =
      size.faces.flatMap(face => face.slice(2).map((corner, i) => [face[0], face[i + 1], corner]));
  return meshGeometry(size.vertices, triangles);
}

/// Flat triangles: every corner is a vertex of its own.
function meshGeometry(vertices, triangles) {
  const geometry = new BufferGeometry();
  const corners = new Float32Array(triangles.flat().flatMap(i => vertices[i]));
  geometry.setAttribute('position', new BufferAttribute(corners, 3));
  geometry.computeVertexNormals();
  return geometry;
}

const place = (object, pose) => {
  object.position.copy(pose.position);
  object.quaternion.copy(pose.quaternion);
};

/// A cylinder from one point to another.
function rod(from, to, radius, material) {
  const along = to.clone().sub(from);
  const mesh = new Mesh(new CylinderGeometry(radius, radius, along.length(), 20), material);
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.setFromUnitVectors(kY, along.normalize());
  return mesh;
}

/// An arrow along y from the origin.
function arrow(length, radius, material) {
  const head = 7 * radius;
  const shaft = new Mesh(new CylinderGeometry(radius, radius, length - head, 14), material);
  shaft.position.y = (length - head) / 2;
  const tip = new Mesh(new ConeGeometry(2.8 * radius, head, 18), material);
  tip.position.y = length - head / 2;
  return new Group().add(shaft, tip);
}

/// Axes of a frame: x red, y green, z blue.
function triad(size) {
  const group = new Group();
  [['#c0392b', 1, 0, 0], ['#2e8b57', 0, 1, 0], ['#2f6fc0', 0, 0, 1]].forEach(([color, ...axis]) => {
    group.add(
        new ArrowHelper(new Vector3(...axis), new Vector3(), size, color, 0.22 * size, 0.1 * size));
  });
  return group;
}

/// The bodies of a robot as groups that follow its posture.
class RobotView {
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
    const drawn = new Set(robot.meshes.map(mesh => mesh.body));
    for (const mesh of robot.meshes) this.addMesh(mesh, materials, options);
    for (const shape of robot.shapes) {
      if (!drawn.has(shape.body)) this.addShape(shape, materials, options);
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

  addMesh(mesh, materials, options) {
    const material = options.ghost ?
        materials.ghost :
        new MeshLambertMaterial({color: mesh.color ?? materials.link.color});
    this.add(
        mesh.body, new Mesh(meshGeometry(mesh.vertices, mesh.triangles), material),
        poseFrom(mesh.pose));
  }

  addShape(shape, materials, options) {
    const geometry = geometryFrom(shape.geometry);
    const material = options.ghost ? materials.ghost :
        shape.body < 0             ? materials.base :
                                     materials.link;
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
    this.robot.joints.forEach((joint, k) => {
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
    robot.joints.forEach(joint => {
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
    this.robot.joints.forEach((joint, k) => frame(k, identityPose(), 0.6 * size));
  }

  addCentroids(materials, size) {
    [this.robot.base, ...this.robot.bodies].forEach((body, i) => {
      const dot = new Mesh(new SphereGeometry(size, 16, 10), materials.centroid);
      dot.position.set(...body.centroid);
      dot.renderOrder = 2;
      this.bodies[i].add(dot);
      this.frames.push(dot);
    });
  }

  move(state) {
    const poses = bodyPoses(this.robot, state.joints);
    place(this.bodies[0], state.base);
    poses.forEach((pose, k) => place(this.body(k), compose(state.base, pose)));
    this.hand = compose(state.base, handPose(this.robot, poses));
  }
}

/// Length of the stretched arm, m.
export function reachOf(robot) {
  const length =
      robot.joints.reduce((sum, joint) => sum + Math.hypot(...joint.pose.slice(0, 3)), 0);
  return Math.max(0.1, length + Math.hypot(...robot.hand.pose.slice(0, 3)));
}

export class Scene {
  /// @param webgl {context: of the canvas, software}
  constructor(canvas, webgl, data, motion) {
    this.software = webgl.software;
    this.data = data;
    this.motion = motion;
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, context: webgl.context});
    this.scene = new ThreeScene();
    this.world = new Group();
    this.scene.add(this.world);
    this.camera = new PerspectiveCamera(38, 1, 0.01, 500);
    this.camera.up.copy(kZ);
    this.hemisphere = new HemisphereLight('#ffffff', '#888888', 1.5);
    this.hemisphere.position.set(0, 0, 1);
    this.sun = new DirectionalLight('#ffffff', 2.1);
    this.fill = new DirectionalLight('#ffffff', 1.3);
    this.scene.add(this.hemisphere, this.sun, this.fill, new AmbientLight('#ffffff', 0.15));
    this.materials = this.makeMaterials();
    this.reach = reachOf(data.robot);
    this.robot = new RobotView(data.robot, this.materials);
    this.robot.addFrames(0.16 * this.reach);
    this.world.add(this.robot.group);
    this.ghost = new RobotView(data.robot, this.materials, {ghost: true});
    this.ghost.group.visible = false;
    this.world.add(this.ghost.group);
    if (data.target) {
      this.addTarget(data.target);
      this.ghostTarget = this.targetGroup(data.target, true);
      this.ghostTarget.visible = false;
      this.world.add(this.ghostTarget);
    }
    this.addObstacles();
    this.addContact();
    this.traces = new Group();
    this.world.add(this.traces);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.requestDraw?.());
    this.follow = 'free';
    this.marked = [];
  }

  makeMaterials() {
    const solid = () => new MeshLambertMaterial();
    const see = () =>
        new MeshBasicMaterial({transparent: true, depthWrite: false, side: DoubleSide});
    return {
      base: solid(),
      link: solid(),
      joint: solid(),
      tool: solid(),
      target: solid(),
      obstacle: solid(),
      feature: new MeshBasicMaterial({side: DoubleSide}),
      edge: new LineBasicMaterial({transparent: true, opacity: 0.55}),
      ghost: new MeshLambertMaterial({transparent: true, opacity: 0.22, depthWrite: false}),
      ghostTarget: new MeshLambertMaterial({transparent: true, opacity: 0.18, depthWrite: false}),
      cone: see(),
      trace: new MeshBasicMaterial(),
      targetTrace: new MeshBasicMaterial(),
      normal: new MeshBasicMaterial(),
      impulse: new MeshBasicMaterial(),
      centroid: new MeshBasicMaterial({depthTest: false, color: '#111111'}),
    };
  }

  /// Colours of light or dark.
  paint(theme) {
    const colors = kPalettes[theme];
    for (const [name, material] of Object.entries(this.materials)) {
      const color = {
        cone: colors.impulse,
        ghostTarget: colors.target,
        centroid: colors.close
      }[name] ??
          colors[name];
      material.color.set(color);
    }
    this.materials.cone.opacity = theme === 'dark' ? 0.22 : 0.16;
    this.hemisphere.color.set(colors.sky);
    this.hemisphere.groundColor.set(colors.ground);
    this.closeColor = new Color(colors.close);
  }

  targetGroup(target, ghost) {
    const group = new Group();
    for (const shape of target.shapes) {
      const geometry = geometryFrom(shape.geometry);
      const mesh = new Mesh(geometry, ghost ? this.materials.ghostTarget : this.materials.target);
      place(mesh, poseFrom(shape.pose));
      group.add(mesh);
      if (ghost || !('box' in shape.geometry || 'convex_mesh' in shape.geometry)) continue;
      const edges = new LineSegments(new EdgesGeometry(geometry, 20), this.materials.edge);
      place(edges, poseFrom(shape.pose));
      group.add(edges);
    }
    return group;
  }

  addTarget(target) {
    this.target = this.targetGroup(target, false);
    this.target.name = 'target';
    this.targetFrame = triad(0.3 * this.reach);
    this.target.add(this.targetFrame);
    for (const feature of target.features) {
      const normal = new Vector3(...feature.normal);
      const chosen = feature.name === target.feature;
      const size = 0.035 * this.reach;
      const ring = new Mesh(new RingGeometry(0.55 * size, size, 32), this.materials.feature);
      ring.quaternion.setFromUnitVectors(kZ, normal);
      ring.position.set(...feature.point).addScaledVector(normal, 0.004 * this.reach);
      this.target.add(ring);
      if (!chosen) continue;
      this.feature = feature;
      const pointer = arrow(0.26 * this.reach, 0.005 * this.reach, this.materials.normal);
      pointer.position.set(...feature.point);
      pointer.quaternion.setFromUnitVectors(kY, normal);
      this.target.add(pointer);
    }
    this.world.add(this.target);
  }

  addObstacles() {
    for (const obstacle of this.data.obstacles ?? []) {
      const mesh = new Mesh(geometryFrom(obstacle.geometry), this.materials.obstacle);
      place(mesh, poseFrom(obstacle.pose));
      (obstacle.on_base ? this.robot.body(-1) : this.world).add(mesh);
    }
  }

  /// Impulse and cone of its directions at the contact, fixed in N.
  addContact() {
    const {contact, robot} = this.data;
    this.impulse = new Group();
    this.impulse.visible = false;
    this.world.add(this.impulse);
    if (!contact) return;
    const base = poseFrom(contact.base);
    const hand = compose(base, handPose(robot, bodyPoses(robot, contact.joints)));
    const force = new Vector3(...contact.impulse);
    if (!(force.length() > 0)) return;
    const direction = force.normalize().applyQuaternion(base.quaternion);
    const length = 0.42 * this.reach;
    const pointer = arrow(length, 0.011 * this.reach, this.materials.impulse);
    const half = this.data.cone_half_angle;
    if (half > 0 && half < 1.4) {
      const cone = new Mesh(
          new ConeGeometry(length * Math.tan(half), length, 48, 1, true), this.materials.cone);
      cone.rotation.x = Math.PI;
      cone.position.y = length / 2;
      pointer.add(cone);
    }
    pointer.position.copy(hand.position);
    pointer.quaternion.setFromUnitVectors(kY, direction);
    this.impulse.add(pointer);
  }

  /// Paths of hand and feature in N under one controller.
  drawTraces(controller) {
    this.traces.clear();
    const hand = [];
    const feature = [];
    const count = 150;
    const {begin, end} = this.motion;
    for (let i = 0; i <= count; ++i) {
      const state = this.motion.at(begin + (end - begin) * i / count, controller);
      hand.push(
          compose(state.base, handPose(this.data.robot, bodyPoses(this.data.robot, state.joints)))
              .position);
      if (state.target && this.feature) feature.push(apply(state.target, this.feature.point));
    }
    if (end <= begin) return;
    const tube = (points, material) => {
      if (points.every(point => point.distanceTo(points[0]) < 1e-6)) return;
      const geometry =
          new TubeGeometry(new CatmullRomCurve3(points), points.length, 0.0028 * this.reach, 4);
      this.traces.add(new Mesh(geometry, material));
    };
    tube(hand, this.materials.trace);
    if (feature.length) tube(feature, this.materials.targetTrace);
  }

  /// @param state of robot and target; ghost: another one, or null
  show(state, ghost, time) {
    this.robot.move(state);
    if (this.target) {
      this.target.visible = state.target !== null;
      if (state.target) place(this.target, state.target);
    }
    this.ghost.group.visible = ghost !== null;
    if (ghost) this.ghost.move(ghost);
    if (this.ghostTarget) {
      this.ghostTarget.visible = Boolean(ghost?.target && ghost.showTarget);
      if (ghost?.target) place(this.ghostTarget, ghost.target);
    }
    this.impulse.visible =
        Boolean(this.data.contact) && time >= (this.motion.waitBegin ?? 0) && time <= 3;
    this.state = state;
    this.world.updateMatrix();
    const anchor = inverse(this.anchorPose());
    place(this.world, anchor);
  }

  /// The frame that stands still on the screen.
  anchorPose() {
    const {state} = this;
    if (this.follow === 'base') return {...state.base};
    if (this.follow === 'hand') return this.robot.hand;
    if (this.follow === 'normal' && state.target && this.feature) {
      const turn = new Quaternion().setFromUnitVectors(kZ, new Vector3(...this.feature.normal));
      return compose(
          state.target, {position: new Vector3(...this.feature.point), quaternion: turn});
    }
    return identityPose();
  }

  /// Colours the bodies named "a with b".
  markPair(pair) {
    for (const mesh of this.marked) mesh.material = mesh.userData.material;
    this.marked = [];
    if (!pair) return;
    const names = pair.split(' with ');
    const links = new Map(this.data.robot.shapes.map(shape => [shape.link, shape.body]));
    for (const name of names) {
      const group = name === 'target' ? this.target :
          links.has(name)             ? this.robot.body(links.get(name)) :
                                        null;
      group?.children.filter(child => child.isMesh && child.material.isMeshLambertMaterial)
          .forEach(mesh => {
            mesh.userData.material = mesh.material;
            mesh.material = mesh.material.clone();
            mesh.material.emissive = this.closeColor;
            mesh.material.emissiveIntensity = 0.32;
            this.marked.push(mesh);
          });
    }
  }

  /// A view that shows robot and target at the contact and at the begin.
  look(follow) {
    this.follow = follow;
    const states = [this.motion.at(0, 0), this.motion.at(this.motion.begin, 0)];
    const at = states[0];
    this.show(at, null, 0);
    const toView = apply.bind(null, inverse(this.anchorPose()));
    const points = [];
    for (const state of follow === 'free' ? states : [at]) {
      points.push(state.base.position);
      const poses = bodyPoses(this.data.robot, state.joints).map(pose => compose(state.base, pose));
      for (const pose of poses) points.push(pose.position);
      if (state.target && this.feature && state === at)
        points.push(apply(state.target, this.feature.point));
    }
    const local = points.map(point => toView(point.toArray()));
    const center =
        local.reduce((sum, point) => sum.add(point), new Vector3()).divideScalar(local.length);
    let radius = Math.max(0.3 * this.reach, ...local.map(point => point.distanceTo(center))) +
        0.25 * this.reach;
    const up = new Vector3(0, 0, 1);
    let from;
    if (follow === 'hand') {
      center.set(0, 0, 0);
      radius = 0.55 * this.reach;
      from = new Vector3(-0.9, -0.75, -0.75);
    } else if (follow === 'normal') {
      center.set(0, 0, 0);
      radius = 0.7 * this.reach;
      from = new Vector3(0.12, 0.16, -1).negate();
      up.set(1, 0, 0);
    } else {
      from = this.sideView(at, toView);
    }
    const distance =
        radius / Math.sin(this.camera.fov * Math.PI / 360) / Math.min(1, this.camera.aspect);
    this.camera.up.copy(up);
    this.camera.position.copy(center).addScaledVector(from.normalize(), distance);
    this.controls.target.copy(center);
    this.controls.object.up.copy(up);
    this.controls.update();
    this.sun.position.copy(this.camera.position).add(new Vector3(1, 2, 4).multiplyScalar(radius));
    this.fill.position.copy(center).sub(this.camera.position);
  }

  /// From the side on which arm and target are seen one beside the other, a little from above.
  sideView(state, toView) {
    const planar = this.data.robot.joints.every(
        joint => Math.abs(joint.pose[4]) + Math.abs(joint.pose[5]) < 1e-9);
    if (planar) return new Vector3(0.02, -0.5, 1);
    const base = toView(state.base.position.toArray());
    const hand = toView(this.robot.hand.position.toArray());
    const along = hand.sub(base);
    const side = new Vector3(along.y, -along.x, 0);
    if (side.length() < 1e-3) side.set(0, -1, 0);
    return side.normalize().addScaledVector(along.normalize(), 0.35).add(new Vector3(0, 0, 0.42));
  }

  resize(width, height) {
    this.size = [width, height];
    this.setRatio(this.plainRatio());
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  plainRatio() {
    return this.software ? 1 : Math.min(globalThis.devicePixelRatio || 1, 2);
  }

  setRatio(ratio) {
    this.ratio = ratio;
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(...this.size, false);
  }

  draw() {
    if (this.ratio !== this.plainRatio()) this.setRatio(this.plainRatio());
    this.renderer.render(this.scene, this.camera);
  }

  /// Where nothing moves software, too, has time for smooth edges: four samples per pixel.
  sharpen() {
    if (!this.software) return this.draw();
    this.setRatio(2);
    this.renderer.render(this.scene, this.camera);
  }
}
