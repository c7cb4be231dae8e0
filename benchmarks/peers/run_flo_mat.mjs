// flo-mat on loops of Beziers: node run_flo_mat.mjs NODE_MODULES CUBICS BUDGET RUNS [POLYLINES]
//
// Scale axis and simplification are switched off: both leave parts of the axis out. Everything else is as it comes.
import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';

const [modules, path, budget, most, out] = process.argv.slice(2);
const { findMats, CpNodeFs } = await import(pathToFileURL(`${modules}/flo-mat/node/index.js`).href);
const { traverseEdges, isTerminating, getMatCurveToNext } = CpNodeFs;

const SAMPLES = 65; // points on a curve of the axis
const given = JSON.parse(readFileSync(path, 'utf8'));
const options = { applySat: false, simplify: false };

function cpuMs() {
    const { user, system } = process.cpuUsage();
    return (user + system) / 1e3;
}

function curves(mats) {
    const found = [];
    for (const mat of mats) {
        traverseEdges(mat.cpNode, node => {
            if (isTerminating(node)) { return; }
            const bezier = getMatCurveToNext(node);
            if (bezier) { found.push(bezier); }
        });
    }
    return found;
}

function at(bezier, t) {
    let level = bezier;
    while (level.length > 1) {
        level = level.slice(1).map((q, i) => [(1 - t) * level[i][0] + t * q[0], (1 - t) * level[i][1] + t * q[1]]);
    }
    return level[0];
}

const spent = [];
let mats;
for (let total = 0; spent.length <= Number(most) && total < 1e3 * Number(budget); total += spent.at(-1)) {
    const begun = cpuMs();
    mats = findMats(given.loops, options);
    spent.push(cpuMs() - begun);
}
// the engine compiles what is slow while it runs: the first half only warms
const counted = spent.slice(spent.length >> 1).sort((a, b) => a - b);
const kept = curves(mats);
if (out) {
    const flat = kept.flatMap(bezier => {
        const count = bezier.length === 2 ? 2 : SAMPLES;
        return [count, ...Array.from({ length: count }, (_, i) => at(bezier, i / (count - 1))).flat()];
    });
    writeFileSync(out, new Uint8Array(Float64Array.from(flat).buffer));
}
const ms = 0.5 * (counted[counted.length >> 1] + counted[(counted.length - 1) >> 1]);
console.log(JSON.stringify({ ms, runs: counted.length, kept: kept.length, given: given.loops.flat().length }));
