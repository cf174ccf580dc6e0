// Geometries of files, and the few that scenes add: rods, arrows, axes.
import {ArrowHelper, BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, ConeGeometry, CylinderGeometry, Group, Mesh, SphereGeometry, Vector3} from 'three';
import {toCreasedNormals} from 'three/addons/utils/BufferGeometryUtils.js';

import {poseFrom} from './kinematics.js';

export const kY = new Vector3(0, 1, 0);
export const kZ = new Vector3(0, 0, 1);

/// A geometry of a file: cylinder and capsule along z, all centred.
export function geometryFrom(geometry) {
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

/// Radius of a sphere about the shape's origin that holds it.
export function sizeOf(geometry) {
  const [kind, size] = Object.entries(geometry)[0];
  if (kind === 'box') return Math.hypot(...size.size) / 2;
  if (kind === 'convex_mesh')
    return Math.max(...size.vertices.map(vertex => Math.hypot(...vertex)));
  return size.radius + (size.length ?? 0) / 2;
}

/// Flat triangles: every corner is a vertex of its own.
export function meshGeometry(vertices, triangles) {
  const geometry = new BufferGeometry();
  const corners = new Float32Array(triangles.flat().flatMap(i => vertices[i]));
  geometry.setAttribute('position', new BufferAttribute(corners, 3));
  geometry.computeVertexNormals();
  return geometry;
}

/// 16-bit numbers, lowest byte first, in base64.
function numbersFrom(text) {
  const bytes = Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Uint16Array.from({length: bytes.length / 2}, (_, i) => view.getUint16(2 * i, true));
}

const decoded = new WeakMap();

/// A mesh of `visuals`, which robot and ghost share: edges of more than 40 degrees stay sharp.
export function visualGeometry(mesh) {
  if (!decoded.has(mesh)) {
    const {low, step} = mesh;
    const places = Float32Array.from(numbersFrom(mesh.vertices), (x, i) => low[i % 3] + step * x);
    const flat = new BufferGeometry();
    flat.setAttribute('position', new BufferAttribute(places, 3));
    flat.setIndex(new BufferAttribute(numbersFrom(mesh.triangles), 1));
    decoded.set(mesh, toCreasedNormals(flat, 40 * Math.PI / 180));
  }
  return decoded.get(mesh);
}

/// A sphere that holds a shape of `visuals`, in the frame of its body: [center, radius].
export function visualSphere(visual, meshes) {
  const pose = poseFrom(visual.pose);
  if (visual.geometry) return [pose.position, sizeOf(visual.geometry)];
  const geometry = visualGeometry(meshes[visual.mesh]);
  geometry.computeBoundingSphere();
  const {center, radius} = geometry.boundingSphere;
  const scale = new Vector3(...visual.scale);
  return [
    center.clone().multiply(scale).applyQuaternion(pose.quaternion).add(pose.position),
    radius * Math.max(...visual.scale.map(Math.abs))
  ];
}

export const place = (object, pose) => {
  object.position.copy(pose.position);
  object.quaternion.copy(pose.quaternion);
};

/// A cylinder from one point to another.
export function rod(from, to, radius, material) {
  const along = to.clone().sub(from);
  const mesh = new Mesh(new CylinderGeometry(radius, radius, along.length(), 20), material);
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.setFromUnitVectors(kY, along.normalize());
  return mesh;
}

/// An arrow along y from the origin.
export function arrow(length, radius, material) {
  const head = 7 * radius;
  const shaft = new Mesh(new CylinderGeometry(radius, radius, length - head, 14), material);
  shaft.position.y = (length - head) / 2;
  const tip = new Mesh(new ConeGeometry(2.8 * radius, head, 18), material);
  tip.position.y = length - head / 2;
  return new Group().add(shaft, tip);
}

/// Axes of a frame: x red, y green, z blue.
export function triad(size) {
  const group = new Group();
  [['#c0392b', 1, 0, 0], ['#2e8b57', 0, 1, 0], ['#2f6fc0', 0, 0, 1]].forEach(([color, ...axis]) => {
    group.add(new ArrowHelper(
        new Vector3(...axis), new Vector3(), size, color, 0.16 * size, 0.055 * size));
  });
  return group;
}
