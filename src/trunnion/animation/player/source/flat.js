// The same bodies on a plain canvas, for browsers without WebGL: lines and areas, the farthest first.
import { colour, css, LOOKS } from "./colours.js"
import { add, placed } from "./vectors.js"

const ROUND = 26
const circle = (put, x, radius, from = 0, to = 2 * Math.PI) => Array.from({ length: ROUND + 1 }, (_, k) => {
  const a = from + (to - from) * k / ROUND
  return put(x, radius * Math.cos(a), radius * Math.sin(a))
})

// Areas and lines of a body: {points, fill, stroke, wide}.
function outline(part, own, share, looks, theme) {
  const found = [], { at, axes, size } = part
  const put = placed(at, axes, own[0] ?? 0)
  const tint = share === null || part.spring < 0 ? looks.steel : css(colour(share, theme))
  const drum = (put, radius, x, length, fill) => {
    for (const end of [x, x + length]) found.push({ points: circle(put, end, radius), fill, stroke: looks.dark, wide: 1 })
    found.push({ points: [put(x, 0, 0), put(x + length, 0, 0)], stroke: fill, wide: 0, body: radius, edge: looks.dark })
  }
  const spoke = (put, x, radius) => found.push({ points: [put(x, 0, 0), put(x, radius, 0)], stroke: looks.mark, wide: 3, near: 0.05 })
  switch (part.shape) {
    case "disk": case "gear": case "rim": case "ring": case "throw": case "drive": {
      const fill = part.shape === "drive" ? looks.drive : part.shape === "gear" || part.shape === "rim" ? (part.spring >= 0 ? tint : looks.gear) : looks.steel
      found.push({ points: [put(-0.15, 0, 0), put(size.length + 0.15, 0, 0)], stroke: looks.dark, wide: 0, body: 0.08, edge: looks.dark })
      drum(put, size.radius, 0, size.length, fill)
      spoke(put, size.length, size.radius); spoke(put, 0, size.radius)
      break
    }
    case "plates": {
      drum(put, size.radius, 0, size.length / 2, looks.dark); spoke(put, 0, size.radius)
      const other = placed(at, axes, own[1])
      drum(other, size.radius, size.length / 2, size.length / 2, tint); spoke(other, size.length, size.radius)
      break
    }
    case "shaft": case "coupling": {
      const r = part.shape === "shaft" ? size.radius : Math.max(2.2 * size.radius, 0.24)
      found.push({ points: [put(0, 0, 0), put(size.length, 0, 0)], stroke: tint, wide: 0, body: r, edge: looks.dark })
      for (const start of [0, Math.PI]) {
        const stripe = Array.from({ length: 13 }, (_, k) => {
          const x = k / 12, turn = own[0] + x * (own[1] - own[0])
          return placed(at, axes, turn)(x * size.length, r * Math.cos(start), r * Math.sin(start))
        })
        found.push({ points: stripe, stroke: looks.ink, wide: 1.6, near: 0.02 })
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
      arms(put, -1, looks.dark); arms(back, 1, looks.gear)
      break
    }
    case "belt": case "link": case "tie":
      found.push({ points: [at, part.far], stroke: part.shape === "tie" ? looks.line : tint, wide: 3 })
      break
  }
  return found
}

export class Flat {
  constructor(canvas, movements, parts, camera, theme) {
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
    shown.forEach(({ angles, torques, most }, row) => {
      g.save(); g.beginPath(); g.rect(0, row * tall, this.width, tall); g.clip()
      const aspect = this.width / tall, scale = tall / 2
      const pixel = p => { const [x, y] = this.camera.seen(p, aspect); return [this.width / 2 + x * scale, row * tall + tall / 2 - y * scale] }
      const unit = scale / this.camera.half(aspect), pieces = []
      this.last = this.parts.map(part => part.stations.map((s, k) => angles[s] - (part.turned[k] ?? 0)))
      this.parts.forEach((part, i) => {
        const share = part.spring >= 0 && torques && most ? torques[part.spring] / most : null
        for (const piece of outline(part, this.last[i], share, looks, this.theme)) {
          const middle = piece.points.reduce((a, b) => add(a, b), [0, 0, 0]).map(x => x / piece.points.length)
          pieces.push({ ...piece, depth: this.camera.seen(middle, aspect)[2] + (piece.near ?? 0) })
        }
      })
      pieces.sort((a, b) => a.depth - b.depth)
      for (const piece of pieces) this.piece(g, piece, pixel, unit)
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
