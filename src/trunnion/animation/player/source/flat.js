// The same bodies on a plain canvas, for browsers without WebGL: lines and areas, the farthest first.
import { colour, css, LOOKS } from "./colours.js"
import { add, cross, dot, length as reach, placed, unit } from "./vectors.js"

const ROUND = 26
const circle = (put, x, radius, from = 0, to = 2 * Math.PI) => Array.from({ length: ROUND + 1 }, (_, k) => {
  const a = from + (to - from) * k / ROUND
  return put(x, radius * Math.cos(a), radius * Math.sin(a))
})

// Areas and lines of a body, the farthest first, for an eye in the direction `out`: {points, fill, stroke, wide}.
function outline(part, own, share, looks, theme, out) {
  const found = [], { at, axes, size } = part, towards = dot(axes.e, out) > 0
  const put = placed(at, axes, own[0] ?? 0)
  const tint = share === null || part.spring < 0 ? looks.steel : css(colour(share, theme))
  const rod = (put, from, to) => found.push({ points: [put(from, 0, 0), put(to, 0, 0)], stroke: looks.dark, wide: 0, body: 0.08, edge: looks.dark })
  const drum = (put, radius, x, length, fill) => {
    const [far, near] = towards ? [x, x + length] : [x + length, x], side = cross(axes.e, out)
    found.push({ points: circle(put, far, radius), fill, stroke: looks.dark, wide: 1 })
    if (reach(side) > 1e-9) {
      const way = unit(side).map(k => radius * k), mid = k => add(at, axes.e, k)
      found.push({ points: [add(mid(far), way), add(mid(near), way), add(mid(near), way, -1), add(mid(far), way, -1)], fill, stroke: looks.dark, wide: 1 })
    }
    found.push({ points: circle(put, near, radius), fill, stroke: looks.dark, wide: 1 })
    found.push({ points: [put(near, 0, 0), put(near, 0.95 * radius, 0)], stroke: looks.mark, wide: 3 })
  }
  switch (part.shape) {
    case "disk": case "gear": case "rim": case "ring": case "throw": case "drive": {
      const fill = part.shape === "drive" ? looks.drive : part.shape === "gear" || part.shape === "rim" ? (part.spring >= 0 ? tint : looks.gear) : looks.steel
      rod(put, -0.15, size.length + 0.15)
      drum(put, size.radius, 0, size.length, fill)
      break
    }
    case "plates": {
      const halves = [() => drum(put, size.radius, 0, size.length / 2, looks.dark),
        () => drum(placed(at, axes, own[1]), size.radius, size.length / 2, size.length / 2, tint)]
      for (const half of towards ? halves : halves.reverse()) half()
      break
    }
    case "shaft": case "coupling": {
      const r = part.shape === "shaft" ? size.radius : Math.max(2.2 * size.radius, 0.24)
      found.push({ points: [put(0, 0, 0), put(size.length, 0, 0)], stroke: tint, wide: 0, body: r, edge: looks.dark })
      for (const start of [0, Math.PI]) {
        const spot = k => placed(at, axes, own[0] + start + k / 12 * (own[1] - own[0]))
        for (let k = 0; k < 12; k++) {
          const foot = spot(k)(0, 0, 0), tip = spot(k)(0, 1, 0)
          if (dot(add(tip, foot, -1), out) > 0) found.push({ points: [spot(k)(k / 12 * size.length, r, 0), spot(k + 1)((k + 1) / 12 * size.length, r, 0)], stroke: looks.ink, wide: 1.6 })
        }
      }
      break
    }
    case "cross": case "joint": {
      const back = placed(at, part.back, own[1]), r = size.radius, reach = size.reach
      const arms = (put, way, look) => {
        found.push({ points: [put(way * reach, 0, 0), put(way * 0.4 * reach, 0, 0)], stroke: look, wide: 0, body: 0.09, edge: looks.dark })
        found.push({ points: [put(0, r, 0), put(way * 0.4 * reach, r, 0), put(way * 0.4 * reach, -r, 0), put(0, -r, 0)], stroke: look, wide: 5 })
        found.push({ points: [put(0, r, 0), put(0, -r, 0)], stroke: looks.joint, wide: 4 })
      }
      const both = [() => arms(put, -1, looks.dark), () => arms(back, 1, looks.gear)]
      for (const one of towards ? both : both.reverse()) one()
      break
    }
    case "belt": case "link": case "tie":
      found.push({ points: [at, part.far], stroke: part.shape === "tie" ? looks.line : tint, wide: 3 })
      break
  }
  return found
}

export class Flat {
  constructor(canvas, parts, camera, theme) {
    this.canvas = canvas; this.parts = parts; this.camera = camera; this.theme = theme
    this.context = canvas.getContext("2d")
    this.last = []
  }

  size(width, height, ratio) {
    this.width = width; this.height = height; this.ratio = ratio
    this.canvas.width = Math.round(width * ratio); this.canvas.height = Math.round(height * ratio)
  }

  draw(shown) {
    const g = this.context, looks = LOOKS[this.theme], tall = this.height / shown.length
    g.setTransform(this.ratio, 0, 0, this.ratio, 0, 0)
    g.fillStyle = looks.ground; g.fillRect(0, 0, this.width, this.height)
    shown.forEach(({ angles, shares }, row) => {
      g.save(); g.beginPath(); g.rect(0, row * tall, this.width, tall); g.clip()
      const aspect = this.width / tall, scale = tall / 2
      const pixel = p => { const [x, y] = this.camera.seen(p, aspect); return [this.width / 2 + x * scale, row * tall + tall / 2 - y * scale] }
      const scaled = scale / this.camera.half(aspect), { out } = this.camera.axes
      this.last = this.parts.map(part => part.stations.map((s, k) => angles[s] - (part.turned[k] ?? 0)))
      const order = this.parts.map((part, i) => [i, dot(part.far ? add(part.at, part.far).map(x => x / 2) : add(part.at, part.axes.e, (part.size.length ?? 0) / 2), out)])
      for (const [i] of order.sort((a, b) => a[1] - b[1])) {
        const part = this.parts[i]
        for (const piece of outline(part, this.last[i], shares[i], looks, this.theme, out)) this.piece(g, piece, pixel, scaled)
      }
      g.restore()
    })
  }

  piece(g, { points, fill, stroke, wide, body, edge }, pixel, unit) {
    g.beginPath()
    points.forEach((p, k) => { const [x, y] = pixel(p); k ? g.lineTo(x, y) : g.moveTo(x, y) })
    g.lineJoin = "round"
    if (fill) { g.closePath(); g.fillStyle = fill; g.fill() }
    if (!stroke) return
    if (body) { g.strokeStyle = edge; g.lineWidth = 2 * body * unit + 2; g.stroke() }
    g.strokeStyle = stroke; g.lineWidth = body ? 2 * body * unit : wide; g.stroke()
  }

  read() { return this.last.map((own, i) => ["tie", "link", "belt"].includes(this.parts[i].shape) ? own.map(() => null) : own) }

  dispose() {}
}
