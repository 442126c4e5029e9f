// Bodies of a line in WebGL. Every body has the axis of its shaft along x, and the direction that angle 0 points to along y.
// They are built of many shapes and drawn as two meshes: what turns together shares a slot, a row of a texture that holds
// where it stands, how it is twisted and by what it is coloured.
import {
  BoxGeometry, BufferGeometry, Color, CylinderGeometry, DataTexture, DoubleSide, ExtrudeGeometry, Float32BufferAttribute,
  FloatType, FrontSide, GLSL3, Group, LatheGeometry, Matrix3, Matrix4, Mesh, NearestFilter, OrthographicCamera, Quaternion,
  RGBAFormat, Scene, ShaderMaterial, Shape, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three"
import { colour, LOOKS } from "./colours.js"
import { add, length as size, unit } from "./vectors.js"

const ROUND = 28
const along = geometry => geometry.rotateZ(-Math.PI / 2)
const round = radius => radius < 0.12 ? 10 : radius < 0.3 ? 18 : ROUND
const bar = (radius, length, from = 0, sides = round(radius)) =>
  along(new CylinderGeometry(radius, radius, length, sides, 1)).translate(from + length / 2, 0, 0)
const box = (x, y, z) => new BoxGeometry(x, y, z)
const vector = a => new Vector3(...a)

function tube(inner, outer, length, from = 0) {
  const points = [[inner, 0], [outer, 0], [outer, length], [inner, length], [inner, 0]].map(p => new Vector2(...p))
  return along(new LatheGeometry(points, ROUND + 8)).translate(from, 0, 0)
}

function toothed(radius, length, teeth) {
  const shape = new Shape(), count = Math.max(8, Math.min(Math.round(teeth), 64)), depth = Math.min(0.12 * radius, 2.2 * radius / count)
  for (let k = 0; k < count; k++) {
    for (const [turn, r] of [[0, radius - depth], [0.25, radius - depth], [0.35, radius + depth / 2], [0.65, radius + depth / 2], [0.75, radius - depth]]) {
      const a = 2 * Math.PI * (k + turn) / count
      k || turn ? shape.lineTo(r * Math.cos(a), r * Math.sin(a)) : shape.moveTo(r * Math.cos(a), r * Math.sin(a))
    }
  }
  return new ExtrudeGeometry(shape, { depth: length, bevelEnabled: false, curveSegments: 1 }).rotateY(Math.PI / 2)
}

// A shaft of many slices, turned by one angle at its beginning and by another at its end; its stripes show the twist.
function twisting(radius, length, sides = radius < 0.22 ? 12 : 20) {
  const fine = along(new CylinderGeometry(radius, radius, length, sides, 8, true)).translate(length / 2, 0, 0)
  const p = fine.attributes.position, tint = []
  for (let k = 0; k < p.count; k++) {
    const sector = Math.round((Math.atan2(p.getZ(k), p.getY(k)) / (2 * Math.PI) + 1) * sides) % (sides / 2)
    tint.push(sector === 0 ? 0.25 : 1)
  }
  fine.setAttribute("stripe", new Float32BufferAttribute(tint, 1))
  return fine
}

class Body {
  constructor(part, scene, looks) {
    this.part = part; this.scene = scene; this.looks = looks
    this.rotors = []      // [object, number of the angle, sense]
    this.twists = []      // [the twist of a slot: its two ends and its length; sense]
    this.tint = null      // the colour that shows the torque
    this.shows = false    // whether anything of it does
    this.moving = []      // functions of the angles
    this.base = this.frame(part.at, part.axes)
    scene.add(this.base)
    this.slot(this.base)
    const build = BUILD[part.shape]
    if (build) build(this, part.size)
  }

  frame(at, axes) {
    const group = new Group()
    group.matrixAutoUpdate = false
    const e = vector(axes.e), u = vector(axes.u)
    group.matrix.makeBasis(e, u, e.clone().cross(u)).setPosition(...at)
    return group
  }

  // Something that moves by itself: all below it has one row of the texture.
  slot(object, twist = null) {
    object.userData.slot = { body: this, twist }
    return object
  }

  material(look) { return { color: new Color(this.looks[look] ?? look), side: FrontSide, shows: false } }

  torque() {
    const found = this.material("steel")
    found.shows = this.part.spring >= 0
    this.shows ||= found.shows
    return found
  }

  rotor(k = 0, base = this.base, sense = this.part.axes.sense) {
    const group = new Group()
    base.add(this.slot(group))
    this.rotors.push([group, k, sense])
    return group
  }

  put(parent, geometry, material) {
    const mesh = new Mesh(geometry, material)
    parent.add(mesh)
    return mesh
  }

  twist(parent, radius, length, from = 0) {
    const ends = [0, 0, length]
    this.twists.push([ends, this.part.axes.sense])
    const made = this.put(parent, twisting(radius, length), this.torque()).translateX(from)
    return this.slot(made, ends)
  }

  // What shows that a round body turns: a bar across both faces.
  mark(parent, radius, length, look = "mark") {
    this.put(parent, box(length + 0.016, 0.86 * radius, 0.09 * radius + 0.012), this.material(look)).position.set(length / 2, 0.5 * radius, 0)
  }

  straight(from, to, radius, material) {
    const mesh = this.put(this.base.parent, bar(radius, size(add(to, from, -1)), 0, 10), material)
    mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(1, 0, 0), vector(unit(add(to, from, -1)))))
    mesh.position.set(...from)
    this.slot(mesh)
  }

  show(angles, torque) {
    const { stations, turned } = this.part
    const own = stations.map((s, k) => angles[s] - (turned[k] ?? 0))
    for (const [group, k, sense] of this.rotors) group.rotation.x = sense * own[k]
    for (const [ends, sense] of this.twists) { ends[0] = sense * own[0]; ends[1] = sense * own[1] }
    for (const move of this.moving) move(own)
    this.tint = this.shows && torque !== null ? new Color().setRGB(...colour(torque, this.theme), "srgb") : null
  }

  // The angles that the drawn bodies stand at, as read from the picture itself.
  read() {
    const found = new Array(this.part.stations.length).fill(null)
    for (const [group, k, sense] of this.rotors) {
      group.updateMatrix()
      found[k] = sense * Math.atan2(group.matrix.elements[6], group.matrix.elements[5])
    }
    for (const [ends, sense] of this.twists) { found[0] = sense * ends[0]; found[1] = sense * ends[1] }
    return found
  }
}

const BUILD = {
  disk(body, { radius, length, before = 0, after = 0 }) {
    const turns = body.rotor(), steel = body.material("steel")
    body.put(turns, bar(radius, length), steel)
    body.put(turns, bar(0.09, length + before + after, -before), body.material("dark"))
    body.mark(turns, radius, length)
  },
  ring(body, { radius, inner, length }) {
    const turns = body.rotor()
    body.put(turns, tube(inner, radius, length), body.material("steel")).material.side = DoubleSide
    body.put(turns, bar(0.08, length, 0), body.material("dark"))
    body.put(turns, box(length + 0.02, radius - inner, 0.09), body.material("mark")).position.set(length / 2, (radius + inner) / 2, 0)
  },
  throw(body, { radius, length, pin = 0, crank = 0.3, before = 0, after = 0 }) {
    const turns = body.rotor(), steel = body.material("steel"), dark = body.material("dark")
    const webs = new Group()
    webs.rotation.x = pin + Math.PI
    turns.add(webs)
    for (const x of [0, 0.75 * length]) {
      body.put(webs, box(0.25 * length, crank + 0.2, 0.2), steel).position.set(x + 0.125 * length, crank / 2, 0)
      body.put(webs, bar(0.2, 0.25 * length, x), steel)
    }
    body.put(webs, bar(0.07, length), dark).position.set(0, crank, 0)
    for (const from of [-before, 0.75 * length]) body.put(turns, bar(0.09, 0.25 * length + Math.max(before, after), from), dark)
    const rod = body.put(body.base, box(0.05, 1, 0.07), dark), piston = body.put(body.base, along(new CylinderGeometry(0.2, 0.2, 0.24, 20)).rotateZ(Math.PI / 2), body.material("gear"))
    const reach = 0.85, middle = length / 2
    body.slot(rod); body.slot(piston)
    body.moving.push(([angle]) => {
      const a = body.part.axes.sense * angle + pin + Math.PI, y = crank * Math.cos(a), z = crank * Math.sin(a)
      const top = -(Math.sqrt(reach * reach - z * z) - y)
      piston.position.set(middle, top, 0)
      rod.position.set(middle, (y + top) / 2, z / 2)
      rod.scale.y = reach
      rod.rotation.x = Math.atan2(z, y - top)
    })
  },
  shaft(body, { radius, length }) { body.twist(body.base, radius, length) },
  coupling(body, { radius, length }) {
    const wide = Math.max(2.2 * radius, 0.24), third = 0.3 * length
    for (const [k, from, flange] of [[0, 0, third - 0.08], [1, length - third, length - third]]) {
      const turns = body.rotor(k)
      body.put(turns, bar(0.09, third, from), body.material("dark"))
      body.put(turns, bar(1.25 * wide, 0.08, flange), body.material("steel"))
      body.put(turns, box(0.1, 0.3 * wide, 0.07), body.material("mark")).position.set(flange + 0.04, 1.1 * wide, 0)
    }
    body.twist(body.base, wide, length - 2 * third, third)
  },
  plates(body, { radius, length }) {
    for (const [k, from] of [[0, 0], [1, length / 2 + 0.03]]) {
      const turns = body.rotor(k)
      body.put(turns, bar(radius, length / 2 - 0.03, from), k ? body.torque() : body.material("dark"))
      body.put(turns, bar(0.09, length / 2 + 0.1, from - (k ? 0 : 0.1)), body.material("dark"))
      body.mark(turns, radius, k ? length : length / 2)
    }
  },
  gear(body, { radius, length, teeth }) {
    const turns = body.rotor()
    const look = body.part.spring >= 0 ? body.torque() : body.material("gear")
    body.put(turns, toothed(radius, length, teeth), look)
    body.put(turns, bar(0.09, 0.6, -0.17), body.material("dark"))
    body.mark(turns, 0.8 * radius, length)
  },
  rim(body, { radius, inner, length }) {
    const turns = body.rotor()
    const look = body.part.spring >= 0 ? body.torque() : body.material("gear")
    body.put(turns, tube(inner, radius, length), look).material.side = DoubleSide
    body.put(turns, bar(0.92 * inner, 0.04, length + 0.05), body.material("dark"))
    body.put(turns, bar(0.09, 0.3, length), body.material("dark"))
    body.put(turns, box(length + 0.02, radius - inner, 0.1), body.material("mark")).position.set(length / 2, (radius + inner) / 2, 0)
  },
  belt(body, { radius, radius_far: other, length }) {
    const middle = body.part.axes.e, a = add(body.part.at, middle, length / 2), b = add(body.part.far, middle, length / 2)
    const way = unit(add(b, a, -1)), side = unit([middle[1] * way[2] - middle[2] * way[1], middle[2] * way[0] - middle[0] * way[2], middle[0] * way[1] - middle[1] * way[0]])
    const look = body.torque()
    for (const s of [-1, 1]) body.straight(add(a, side, s * radius), add(b, side, s * other), 0.05, look)
  },
  cross(body, { reach, radius }) {
    const front = body.rotor(0), behind = body.frame(body.part.at, body.part.back)
    body.scene.add(body.slot(behind))
    const back = body.rotor(1, behind, body.part.back.sense)
    const yoke = (turns, way, look) => {
      const metal = body.material(look), hub = 0.42 * reach
      body.put(turns, bar(0.09, reach - hub, way < 0 ? -reach : hub), body.material("dark"))
      body.put(turns, box(0.1, 2 * radius + 0.08, 0.13), metal).position.set(way * hub, 0, 0)
      for (const s of [-1, 1]) body.put(turns, box(hub + 0.1, 0.08, 0.15), metal).position.set(way * (hub / 2 - 0.02), s * radius, 0)
      const pin = body.put(turns, new CylinderGeometry(0.05, 0.05, 2 * radius + 0.1, 12), body.material("joint"))
      pin.position.set(0, 0, 0)
    }
    yoke(front, -1, "steel"); yoke(back, 1, "gear")
  },
  joint(body, { reach, radius }) {
    const front = body.rotor(0), behind = body.frame(body.part.at, body.part.back)
    body.scene.add(body.slot(behind))
    const back = body.rotor(1, behind, body.part.back.sense)
    body.put(front, bar(0.09, reach, -reach), body.material("dark"))
    body.put(front, new SphereGeometry(radius, 16, 10), body.material("joint"))
    body.put(front, box(0.1, 2.2 * radius, 0.06), body.material("mark"))
    body.put(back, bar(0.09, reach, 0), body.material("dark"))
    body.put(back, bar(1.1 * radius, 0.1, 0.2 * reach), body.material("steel"))
    body.put(back, box(0.12, 0.5 * radius, 0.06), body.material("mark")).position.set(0.2 * reach + 0.05, 0.95 * radius, 0)
  },
  drive(body, { radius, length }) {
    body.put(body.base, bar(radius, length, -0.06), body.material("drive"))
    const turns = body.rotor()
    body.put(turns, bar(0.09, 0.3, length - 0.1), body.material("dark"))
    body.put(turns, bar(0.5 * radius, 0.05, length - 0.04), body.material("steel"))
    body.put(turns, box(0.06, 0.5 * radius, 0.07), body.material("mark")).position.set(length, 0.28 * radius, 0)
  },
  tie(body) { body.straight(body.part.at, body.part.far, 0.05, body.material("line")) },
  link(body) { body.straight(body.part.at, body.part.far, 0.05, body.torque()) },
}

const ROWS = 5   // texels of a slot: three of its matrix, its twist, its colour
const VERTEX = `
uniform highp sampler2D slots;
in vec3 own; in vec3 paint;
out vec3 front;
#ifdef BOTH
out vec3 back;
#endif
vec3 lit(vec3 diffuse, vec3 n) {
  float light = 1.15 + 2.1 * max(dot(n, vec3(-0.28735, -0.57470, 0.76626)), 0.0) + 0.7 * max(dot(n, vec3(0.59628, 0.74536, -0.29814)), 0.0);
  vec3 c = diffuse * light * 0.3183099;
  return mix(c * 12.92, 1.055 * pow(c, vec3(0.4166667)) - 0.055, step(0.0031308, c));
}
void main() {
  int k = int(own.x + 0.5);
  vec4 x = texelFetch(slots, ivec2(0, k), 0), y = texelFetch(slots, ivec2(1, k), 0), z = texelFetch(slots, ivec2(2, k), 0);
  vec4 twist = texelFetch(slots, ivec2(3, k), 0), shade = texelFetch(slots, ivec2(4, k), 0);
  float a = mix(twist.x, twist.y, clamp(position.x / twist.z, 0.0, 1.0)), c = cos(a), s = sin(a);
  mat3 turn = mat3(1.0, 0.0, 0.0, 0.0, c, s, 0.0, -s, c);
  vec4 p = vec4(turn * position, 1.0);
  vec3 n = turn * normal, at = vec3(dot(x, p), dot(y, p), dot(z, p));
  n = normalize(vec3(dot(x.xyz, n), dot(y.xyz, n), dot(z.xyz, n)));
  vec3 diffuse = mix(paint, shade.rgb, shade.a * own.y) * own.z;
  front = lit(diffuse, n);
#ifdef BOTH
  back = lit(diffuse, -n);
#endif
  gl_Position = projectionMatrix * viewMatrix * vec4(at, 1.0);
}`
const FRAGMENT = `
in vec3 front;
out vec4 seen;
#ifdef BOTH
in vec3 back;
void main() { seen = vec4(gl_FrontFacing ? front : back, 1.0); }
#else
void main() { seen = vec4(front, 1.0); }
#endif`

// All shapes of one side in one geometry, each in the frame of its slot.
function merged(meshes, numberOf) {
  const position = [], normal = [], paint = [], own = [], index = []
  const far = new Matrix4(), turn = new Matrix3(), v = new Vector3()
  for (const mesh of meshes) {
    let owner = mesh
    while (!owner.userData.slot) owner = owner.parent
    far.copy(owner.matrixWorld).invert().multiply(mesh.matrixWorld)
    turn.getNormalMatrix(far)
    const { geometry, material } = mesh, p = geometry.attributes.position, n = geometry.attributes.normal
    const first = position.length / 3, stripe = geometry.attributes.stripe
    for (let k = 0; k < p.count; k++) {
      position.push(...v.fromBufferAttribute(p, k).applyMatrix4(far))
      normal.push(...v.fromBufferAttribute(n, k).applyMatrix3(turn).normalize())
      paint.push(material.color.r, material.color.g, material.color.b)
      own.push(numberOf.get(owner), material.shows ? 1 : 0, stripe ? stripe.getX(k) : 1)
    }
    if (geometry.index) for (const k of geometry.index.array) index.push(first + k)
    else for (let k = 0; k < p.count; k++) index.push(first + k)
    geometry.dispose()
  }
  const found = new BufferGeometry()
  for (const [name, values] of Object.entries({ position, normal, paint, own })) found.setAttribute(name, new Float32BufferAttribute(values, 3))
  return found.setIndex(index)
}

export class Solid {
  constructor(canvas, parts, camera, theme) {
    this.canvas = canvas
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: "low-power" })
    this.renderer.autoClear = false
    this.eye = new OrthographicCamera(-1, 1, 1, -1, -200, 400)
    this.eye.matrixAutoUpdate = false
    this.rebuild(parts, camera, theme)
  }

  // Other bodies in the same context.
  rebuild(parts, camera, theme) {
    this.empty()
    this.camera = camera; this.theme = theme
    const looks = LOOKS[theme]
    this.renderer.setClearColor(looks.ground)
    this.model = new Group()
    this.bodies = parts.map(part => new Body(part, this.model, looks))
    for (const body of this.bodies) { body.theme = theme; body.show(new Float64Array(1 + Math.max(0, ...body.part.stations)), null) }
    this.model.updateMatrixWorld(true)
    this.slots = []
    const numberOf = new Map(), sides = { [FrontSide]: [], [DoubleSide]: [] }
    this.model.traverse(one => {
      if (one.userData.slot) { numberOf.set(one, this.slots.length); this.slots.push(one) }
      if (one.isMesh) sides[one.material.side].push(one)
    })
    this.data = new Float32Array(4 * ROWS * Math.max(this.slots.length, 1))
    this.texture = new DataTexture(this.data, ROWS, Math.max(this.slots.length, 1), RGBAFormat, FloatType)
    this.texture.minFilter = this.texture.magFilter = NearestFilter
    this.scene = new Scene()
    for (const side of [FrontSide, DoubleSide]) {
      if (!sides[side].length) continue
      const material = new ShaderMaterial({ uniforms: { slots: { value: this.texture } }, vertexShader: VERTEX, fragmentShader: FRAGMENT,
        glslVersion: GLSL3, side, defines: side === DoubleSide ? { BOTH: "" } : {} })
      const mesh = new Mesh(merged(sides[side], numberOf), material)
      mesh.frustumCulled = false
      mesh.matrixAutoUpdate = false
      this.scene.add(mesh)
    }
  }

  // Where everything stands, as the texture has it.
  place() {
    this.model.updateMatrixWorld(true)
    this.slots.forEach((one, k) => {
      const m = one.matrixWorld.elements, { body, twist } = one.userData.slot, tint = body.tint
      this.data.set([m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14],
        twist ? twist[0] : 0, twist ? twist[1] : 0, twist ? twist[2] : 1, 0,
        tint ? tint.r : 0, tint ? tint.g : 0, tint ? tint.b : 0, tint ? 1 : 0], 4 * ROWS * k)
    })
    this.texture.needsUpdate = true
  }

  empty() {
    this.scene?.traverse(one => { one.geometry?.dispose(); one.material?.dispose?.() })
    this.texture?.dispose()
  }

  size(width, height, ratio) {
    this.width = width; this.height = height
    this.renderer.setPixelRatio(ratio)
    this.renderer.setSize(width, height, false)
  }

  // One picture a row, the first on top: what each body is turned by, and coloured by.
  draw(shown) {
    const rows = shown.length, tall = this.height / rows
    this.renderer.setScissorTest(false)
    this.renderer.clear()
    this.renderer.setScissorTest(rows > 1)
    shown.forEach(({ angles, shares }, row) => {
      this.bodies.forEach((body, i) => body.show(angles, shares[i]))
      this.place()
      this.look(this.width / tall)
      const bottom = this.height - (row + 1) * tall
      this.renderer.setViewport(0, bottom, this.width, tall)
      this.renderer.setScissor(0, bottom, this.width, tall)
      this.renderer.render(this.scene, this.eye)
    })
  }

  look(aspect) {
    const half = this.camera.half(aspect), { right, up, out } = this.camera.axes, eye = this.eye
    eye.left = -half * aspect; eye.right = half * aspect; eye.top = half; eye.bottom = -half
    eye.matrix = new Matrix4().makeBasis(vector(right), vector(up), vector(out)).setPosition(...add(this.camera.target, out, 60))
    eye.matrixWorldNeedsUpdate = true
    eye.updateProjectionMatrix()
  }

  read() { return this.bodies.map(body => body.read()) }

  dispose() {
    this.empty()
    this.renderer.dispose()
    this.renderer.forceContextLoss()
  }
}
