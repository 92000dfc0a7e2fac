// Trains the network of the exhibit `network`: 3 → 16 → 16 → 1, the occupancy of a kettlebell, a ball with a handle.
//
//   node scripts/train_network.mjs > ../crates/chordal-wasm/src/exhibits/network_weights.txt
//
// Only +, −, ×, ÷ and the square root are used, with random numbers of its own, so that every machine writes the same
// weights. The activation is x / √(1 + x²), which the core can also evaluate over intervals.
const SIZES = [3, 16, 16, 1];
const STEPS = 60_000;
const BATCH = 128;

let seed = 20240607;
/** From 0 to 1; a linear congruential generator (Park, Miller). */
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
const between = (low, high) => low + (high - low) * random();

/** The distance to the kettlebell. */
function distance([x, y, z]) {
  const ball = Math.sqrt(x * x + y * y + (z + 0.25) * (z + 0.25)) - 0.55;
  const ring = Math.sqrt(x * x + (z - 0.38) * (z - 0.38)) - 0.36;
  return Math.min(ball, Math.sqrt(ring * ring + y * y) - 0.13);
}

/** Half of the points anywhere, half near the surface. */
function sample() {
  for (;;) {
    const point = [between(-1, 1), between(-1, 1), between(-1, 1)];
    if (random() < 0.5 || Math.abs(distance(point)) < 0.08) return point;
  }
}

const layers = SIZES.slice(1).map((outputs, l) => {
  const inputs = SIZES[l];
  const reach = l === 0 ? 3 : 2 / Math.sqrt(inputs);
  const numbers = () => Array.from({ length: outputs * (inputs + 1) }, () => between(-reach, reach));
  const values = numbers();
  return { inputs, outputs, values, gradient: values.map(() => 0), mean: values.map(() => 0), square: values.map(() => 0) };
});

/** The activations of each layer; the last one is not bent. */
function forward(point) {
  const all = [point];
  layers.forEach(({ inputs, outputs, values }, l) => {
    const before = all[l];
    const after = [];
    for (let o = 0; o < outputs; o++) {
      let sum = values[o * (inputs + 1) + inputs];
      for (let i = 0; i < inputs; i++) sum += values[o * (inputs + 1) + i] * before[i];
      after.push(l < layers.length - 1 ? sum / Math.sqrt(1 + sum * sum) : sum);
    }
    all.push(after);
  });
  return all;
}

function backward(all, slope) {
  let slopes = [slope];
  for (let l = layers.length - 1; l >= 0; l--) {
    const { inputs, outputs, values, gradient } = layers[l];
    const before = all[l];
    const next = before.map(() => 0);
    for (let o = 0; o < outputs; o++) {
      for (let i = 0; i < inputs; i++) {
        gradient[o * (inputs + 1) + i] += slopes[o] * before[i];
        next[i] += slopes[o] * values[o * (inputs + 1) + i];
      }
      gradient[o * (inputs + 1) + inputs] += slopes[o];
    }
    // The derivative of x / √(1 + x²) is (1 − y²)^1.5.
    slopes = next.map((slope, i) => slope * (1 - before[i] ** 2) * Math.sqrt(1 - before[i] ** 2));
  }
}

const RATES = [0.9, 0.999];
let powers = [1, 1];
let losses = 0;
for (let step = 1; step <= STEPS; step++) {
  layers.forEach(({ gradient }) => gradient.fill(0));
  for (let k = 0; k < BATCH; k++) {
    const point = sample();
    const all = forward(point);
    const out = all.at(-1)[0];
    const occupancy = 0.5 + (0.5 * out) / Math.sqrt(1 + out * out);
    const truth = distance(point) < 0 ? 1 : 0;
    losses += Math.abs(occupancy - truth) > 0.5 ? 1 : 0;
    // The derivative of the cross entropy by the last sum.
    backward(all, (2 * (occupancy - truth)) / Math.sqrt(1 + out * out) / BATCH);
  }
  powers = powers.map((power, k) => power * RATES[k]);
  const rate = 0.004 * (step < STEPS / 2 ? 1 : 2 * (1 - step / STEPS));
  for (const { values, gradient, mean, square } of layers) {
    for (let i = 0; i < values.length; i++) {
      mean[i] = RATES[0] * mean[i] + (1 - RATES[0]) * gradient[i];
      square[i] = RATES[1] * square[i] + (1 - RATES[1]) * gradient[i] ** 2;
      values[i] -= (rate * mean[i]) / (1 - powers[0]) / (Math.sqrt(square[i] / (1 - powers[1])) + 1e-8);
    }
  }
  if (step % 5000 === 0) {
    console.error(`${step}: ${((100 * losses) / BATCH / 5000).toFixed(2)} % wrong`);
    losses = 0;
  }
}
// Four digits are enough for the picture; a row for each unit: its weights, then its bias.
for (const { inputs, outputs, values } of layers) {
  for (let o = 0; o < outputs; o++) {
    console.log(values.slice(o * (inputs + 1), (o + 1) * (inputs + 1)).map((x) => x.toFixed(4)).join(" "));
  }
}
