// The scene: robot, target, feature, impulse, and what is drawn of their motion. World is the
// inertial frame, z up.
import {AmbientLight, BufferGeometry, CatmullRomCurve3, Color, ConeGeometry, DirectionalLight, DoubleSide, EdgesGeometry, Group, HemisphereLight, Line, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, RingGeometry, Scene as ThreeScene, SphereGeometry, TubeGeometry, Vector3, WebGLRenderer} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';

import {fit, inView, viewDirection, viewFrames} from './cameras.js';
import {Gap} from './gap.js';
import {apply, bodyPoses, compose, handPose, inverse, poseFrom} from './kinematics.js';
import {kPalettes} from './palettes.js';
import {reachOf, RobotView} from './robot_view.js';
import {arrow, geometryFrom, kY, kZ, place, sizeOf, triad, visualSphere} from './shapes.js';

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
    this.hemisphere = new HemisphereLight('#ffffff', '#888888', 1.35);
    this.hemisphere.position.set(0, 0, 1);
    this.sun = new DirectionalLight('#ffffff', 1.55);
    this.fill = new DirectionalLight('#ffffff', 0.45);
    this.scene.add(this.hemisphere, this.sun, this.fill, new AmbientLight('#ffffff', 0.15));
    this.materials = this.makeMaterials();
    this.reach = reachOf(data.robot);
    this.robot = new RobotView(data.robot, this.materials);
    this.robot.addFrames(0.16 * this.reach);
    this.robot.addCentroids(this.materials, 0.011 * this.reach);
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
    this.addEllipsoid();
    this.gap = new Gap(this.reach);
    this.world.add(this.gap.group);
    this.traces = new Group();
    this.world.add(this.traces);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.requestDraw?.());
    this.marked = [];
  }

  makeMaterials() {
    const solid = () => new MeshLambertMaterial();
    const see = () =>
        new MeshBasicMaterial({transparent: true, depthWrite: false, side: DoubleSide});
    return {
      base: solid(),
      link: solid(),
      openBase: new MeshLambertMaterial({side: DoubleSide}),
      openLink: new MeshLambertMaterial({side: DoubleSide}),
      joint: solid(),
      tool: solid(),
      target: solid(),
      obstacle: solid(),
      feature: new MeshBasicMaterial({side: DoubleSide}),
      edge: new LineBasicMaterial({transparent: true, opacity: 0.55}),
      ghost: new MeshLambertMaterial({transparent: true, opacity: 0.22, depthWrite: false}),
      ghostTarget: new MeshLambertMaterial({transparent: true, opacity: 0.18, depthWrite: false}),
      cone: see(),
      ellipsoid: new MeshBasicMaterial(
          {transparent: true, opacity: 0.32, depthWrite: false, depthTest: false}),
      ellipsoidLine: new LineBasicMaterial({depthTest: false}),
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
        ellipsoid: colors.ghost,
        ellipsoidLine: colors.ghost,
        openBase: colors.base,
        openLink: colors.link,
        ghostTarget: colors.target,
        centroid: colors.tool
      }[name] ??
          colors[name];
      material.color.set(color);
    }
    this.materials.cone.opacity = theme === 'dark' ? 0.22 : 0.16;
    this.hemisphere.color.set(colors.sky);
    this.hemisphere.groundColor.set(colors.ground);
    this.closeColor = new Color(colors.close);
    this.gap.material.color.copy(this.closeColor);
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

  /// Three standard deviations of the feature's predicted position, drawn over the bodies. One that
  /// is too small to see is drawn larger, `ellipsoid.factor` times.
  addEllipsoid() {
    const {contact_ellipsoid: ellipsoid} = this.data;
    const largest = ellipsoid ? 3 * Math.max(...ellipsoid.deviations) : 0;
    if (!(largest > 0)) return;
    const factor = 10 ** Math.max(0, Math.ceil(Math.log10(0.02 * this.reach / largest)));
    const body = new Group();
    const mesh = new Mesh(new SphereGeometry(1, 32, 20), this.materials.ellipsoid);
    mesh.renderOrder = 1;
    body.add(mesh);
    for (const plane of [[0, 1], [1, 2], [2, 0]]) {
      const points = Array.from({length: 65}, (_, i) => {
        const point = [0, 0, 0];
        point[plane[0]] = Math.cos(i * Math.PI / 32);
        point[plane[1]] = Math.sin(i * Math.PI / 32);
        return new Vector3(...point);
      });
      const line =
          new Line(new BufferGeometry().setFromPoints(points), this.materials.ellipsoidLine);
      line.renderOrder = 2;
      body.add(line);
    }
    place(body, poseFrom(ellipsoid.pose));
    body.scale.set(
        ...ellipsoid.deviations.map(each => Math.max(3 * factor * each, 1e-3 * this.reach)));
    this.impulse.add(body);
    this.ellipsoid = {factor, largest};
  }

  /// From the wait until 3 s after the contact.
  showsImpulse(time) {
    return Boolean(this.data.contact) && time >= (this.motion.waitBegin ?? 0) && time <= 3;
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
      hand.push(this.handAt(state).position);
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
    this.impulse.visible = this.showsImpulse(time);
    if (this.viewFrame)
      place(this.world, inverse(this.viewFrame({...state, hand: this.robot.hand})));
  }

  /// The group that carries a link, an obstacle or the target; null: it stands still in N.
  carrier(name) {
    if (name === 'target') return this.target;
    const shape = this.data.robot.shapes.find(each => each.link === name);
    if (shape) return this.robot.body(shape.body);
    const obstacle = this.data.obstacles?.find(each => each.name === name);
    return obstacle?.on_base ? this.robot.body(-1) : null;
  }

  /// Colours two bodies, and draws the gap between them.
  /// @param near {names, points: on each in the frame of its carrier, or null, distance}, or null
  markPair(near) {
    for (const mesh of this.marked) mesh.material = mesh.userData.material;
    this.marked = [];
    const carriers = near?.names.map(name => this.carrier(name)) ?? [];
    for (const group of carriers) {
      group?.children.filter(child => child.isMesh && child.material.isMeshLambertMaterial)
          .forEach(mesh => {
            mesh.userData.material = mesh.material;
            mesh.material = mesh.material.clone();
            mesh.material.emissive = this.closeColor;
            mesh.material.emissiveIntensity = 0.22;
            this.marked.push(mesh);
          });
    }
    const points = near?.points?.map(
        (point, i) => carriers[i] ? apply(carriers[i], point) : new Vector3(...point));
    this.gap.show(points ?? null, near?.distance);
  }

  /// Spheres that hold what a view has to show, in the world's frame: bodies at the begin and at
  /// the contact, the target at the contact. [center, radius]
  extent(states) {
    const {robot, target} = this.data;
    const spheres = [];
    for (const state of states) {
      const poses =
          [state.base, ...bodyPoses(robot, state.joints).map(pose => compose(state.base, pose))];
      for (const shape of robot.shapes) {
        const pose = compose(poses[shape.body + 1], poseFrom(shape.pose));
        spheres.push([pose.position, sizeOf(shape.geometry)]);
      }
      for (const visual of robot.visuals?.shapes ?? []) {
        const [center, radius] = visualSphere(visual, robot.visuals.meshes);
        spheres.push([apply(poses[visual.body + 1], center), radius]);
      }
      for (const pose of poses) spheres.push([pose.position, 0.05 * this.reach]);
    }
    const {begin} = this.motion;
    for (let i = 0; i <= 20; ++i) {
      spheres.push([this.handAt(this.motion.at(begin * i / 20, 0)).position, 0.03 * this.reach]);
    }
    if (states[0].target) {
      for (const shape of target.shapes) {
        spheres.push([
          compose(states[0].target, poseFrom(shape.pose)).position,
          Math.min(sizeOf(shape.geometry), 0.6 * this.reach)
        ]);
      }
      if (this.feature)
        spheres.push([apply(states[0].target, this.feature.point), 0.1 * this.reach]);
    }
    return spheres;
  }

  /// Takes one of kCameras.
  look(name) {
    const states = [this.motion.at(0, 0), this.motion.at(this.motion.begin, 0)];
    const planar =
        this.data.robot.tree.every(joint => Math.hypot(joint.pose[4], joint.pose[5]) < 1e-9);
    const contact = {...states[0], hand: this.handAt(states[0])};
    const bodies =
        bodyPoses(this.data.robot, contact.joints).map(pose => compose(contact.base, pose));
    const frames = viewFrames(contact, bodies, this.feature, planar);
    this.viewFrame = frames[name] ?? frames.free;
    const from = viewDirection(name, planar);
    let center = new Vector3();
    let distance = (name === 'normal' ? 0.75 : 1.5) * this.reach;
    if (name === 'free' || name === 'base') {
      const frame = this.viewFrame(contact);
      const spheres = this.extent(states).map(([point, radius]) => [inView(frame, point), radius]);
      ({center, distance} = fit(spheres, from, this.camera));
    }
    this.camera.position.copy(center).addScaledVector(from, distance);
    this.controls.target.copy(center);
    this.controls.update();
    this.sun.position.set(-2, -3, 5);
    this.fill.position.set(3, -4, 0.5);
  }

  handAt(state) {
    return compose(state.base, handPose(this.data.robot, bodyPoses(this.data.robot, state.joints)));
  }

  resize(width, height) {
    this.size = [width, height];
    this.setRatio(this.plainRatio());
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  /// Pixels of the scene per pixel of the page. Software draws fewer while things move.
  plainRatio() {
    return this.software ? 0.75 : Math.min(globalThis.devicePixelRatio || 1, 2);
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
