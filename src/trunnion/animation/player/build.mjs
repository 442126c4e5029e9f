// Builds player.js, one script with three.js in it: `npm ci && npm run build` in this folder.
//
// It is an IIFE that leaves `TrunnionPlayer`, for pages that open from a file, where modules are refused; behind the mark
// stands what makes a module of the same text, for Panel. What it was built from is written at its head, and a test
// compares that with what stands here.
import { build } from "esbuild"
import { createHash } from "node:crypto"
import { readFileSync, writeFileSync, readdirSync } from "node:fs"

const read = path => readFileSync(new URL(path, import.meta.url))
const sources = readdirSync(new URL("source/", import.meta.url)).sort()
const hash = createHash("sha256")
for (const name of ["package-lock.json", "build.mjs"]) hash.update(read(name))
for (const name of sources) hash.update(read("source/" + name))
const of = name => JSON.parse(read(`node_modules/${name}/package.json`)).version
const head = `/* Trunnion's player, with three.js ${of("three")} (MIT, Copyright 2010-2026 three.js authors; see LICENSE-three.txt). `
  + `Built by esbuild ${of("esbuild")} from sha256-${hash.digest("hex")}; do not edit, see build.mjs. */`
const made = await build({
  entryPoints: [new URL("source/index.js", import.meta.url).pathname],
  bundle: true, minify: true, format: "iife", globalName: "TrunnionPlayer", target: "es2020", charset: "ascii",
  legalComments: "none", write: false, banner: { js: head },
})
const text = made.outputFiles[0].text.replaceAll("</", "<\\/").trimEnd()
writeFileSync(new URL("player.js", import.meta.url),
  text + "\n/* module */\nexport const render = TrunnionPlayer.render; export default { render };\n")
writeFileSync(new URL("LICENSE-three.txt", import.meta.url), read("node_modules/three/LICENSE"))
