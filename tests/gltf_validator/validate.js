// Runs Khronos' glTF validator over the built-in scenes, as stored and as `peel` writes them now,
// binary form included. Fails on any error or warning.
// Usage: node validate.js PEEL SCENES_FOLDER
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [peel, folder] = process.argv.slice(2);

function install() {
  if (existsSync(join(here, "node_modules", "gltf-validator"))) return;
  execFileSync("npm", ["ci", "--no-audit", "--no-fund"], { cwd: here, stdio: "inherit" });
}

function writeScenes(target) {
  const names = execFileSync(peel, ["scenes"], { encoding: "utf8" })
    .split("\n")
    .filter((line) => line)
    .map((line) => line.split(" ")[0]);
  return names.flatMap((name) =>
    ["gltf", "glb"].map((extension) => {
      const path = join(target, `${name}.${extension}`);
      execFileSync(peel, ["scenes", name, "-o", path]);
      return path;
    }),
  );
}

async function validate(validator, path) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), {
    externalResourceFunction: () => Promise.reject(new Error("no external resources expected")),
  });
  const { numErrors, numWarnings, messages } = report.issues;
  console.log(`${path}: ${numErrors} errors, ${numWarnings} warnings`);
  for (const message of messages.slice(0, 10))
    console.log(`  ${message.code} at ${message.pointer}: ${message.message}`);
  return numErrors + numWarnings === 0;
}

install();
const validator = (await import("gltf-validator")).default;
const target = mkdtempSync(join(tmpdir(), "peel-gltf-"));
try {
  const stored = readdirSync(folder)
    .filter((name) => /\.(gltf|glb)$/.test(name))
    .map((name) => join(folder, name));
  const paths = [...stored, ...writeScenes(target)];
  if (stored.length < 6 || paths.length < 18)
    throw new Error(`${paths.length} files found, expected at least 18`);
  const good = [];
  for (const path of paths) good.push(await validate(validator, path));
  process.exitCode = good.every(Boolean) ? 0 : 1;
} finally {
  rmSync(target, { recursive: true });
}
