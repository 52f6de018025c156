// The environment for rays, and the tables by which they choose directions of it.
// twin: src/gl/environment_upload.cpp.
import { aliasTable } from './alias_table.js';
import { luminance } from './file.js';
import { createTexture2D } from './gl.js';
import { createTable } from './tables.js';

// Of half floats.
const kMaxRadiance = 65504;
// Of a larger picture, texels are chosen together. twin: src/gl/environment_upload.cpp.
const kMaxCells = 1 << 19;
const kMinOverMean = 2; // twin: src/core/render/traced_reflections.h
const kSkyPoints = 32; // twin: shaders/lib/sky_at_hits.glsl

// Luminance of the bilinear radiance, whose mean over a texel takes an eighth from either neighbour along an axis.
function lightOfTexels({ width, height, data }) {
    const mean = (before, own, after) => 0.75 * own + 0.125 * (before + after),
        own = Float64Array.from({ length: width * height }, (_, i) => luminance(data.subarray(4 * i, 4 * i + 3))),
        along = own.map((light, i) => {
            const x = i % width,
                row = i - x;
            return mean(own[row + ((x + width - 1) % width)], light, own[row + ((x + 1) % width)]);
        });
    return along.map((light, i) =>
        mean(along[i < width ? i : i - width], light, along[i + width < along.length ? i + width : i]),
    );
}

// What of it is sampled, times a number that is as the texel's solid angle.
function sampledLight(image, heightOf) {
    const { width } = image,
        light = lightOfTexels(image),
        heights = light.map((_, i) => heightOf(Math.floor(i / width), Math.floor(i / width) + 1)),
        mean = light.reduce((sum, of, i) => sum + of * heights[i], 0) / (2 * width);
    return light.map((of, i) => Math.max(of - kMinOverMean * mean, 0) * heights[i]);
}

// { columns, rows, chances, densities }: chances of cells, of the sum 1, or none where nothing is sampled; densities of texels,
// 1/sr. Rows from +Y.
function chancesOf(image, cellTexels) {
    const { width, height } = image,
        columns = Math.ceil(width / cellTexels),
        rows = Math.ceil(height / cellTexels),
        // Between the planes of rows' borders on the unit sphere.
        heightOf = (low, high) => Math.cos((Math.PI * low) / height) - Math.cos((Math.PI * high) / height),
        light = sampledLight(image, heightOf),
        cells = new Float64Array(columns * rows),
        cellOf = (i) => Math.floor(Math.floor(i / width) / cellTexels) * columns + Math.floor((i % width) / cellTexels);
    light.forEach((of, i) => {
        cells[cellOf(i)] += of;
    });
    const sum = cells.reduce((a, b) => a + b, 0);
    const chances = sum > 0 ? cells.map((of) => of / sum) : null,
        within = (low, size) => Math.min(low + cellTexels, size);
    const densities = light.map((_, i) => {
        const cell = cellOf(i),
            left = cellTexels * (cell % columns),
            top = cellTexels * Math.floor(cell / columns),
            heights = heightOf(top, within(top, height));
        return ((chances?.[cell] ?? 0) * width) / (heights * 2 * Math.PI * (within(left, width) - left));
    });
    return { columns, rows, chances, densities };
}

// Threshold and alias of each entry: of the rows, then of each row's cells.
function choiceEntries({ columns, rows, chances }) {
    const count = rows + rows * columns,
        table = new Uint32Array(2 * (count + (count % 2))),
        floats = new Float32Array(table.buffer);
    const add = (first, of) => {
        const { thresholds, aliases } = aliasTable(of);
        of.forEach((_, i) => {
            floats[2 * (first + i)] = thresholds[i];
            table[2 * (first + i) + 1] = aliases[i];
        });
    };
    const cellsOf = (row) => [...chances.subarray(columns * row, columns * (row + 1))],
        sums = Array.from({ length: rows }, (_, row) => cellsOf(row).reduce((a, b) => a + b, 0));
    add(0, sums);
    sums.forEach((sum, row) =>
        add(rows + columns * row, cellsOf(row).map((chance) => (sum > 0 ? chance / sum : 1 / columns))),
    );
    return table;
}

// Mean of the bilinear radiance over a cell.
function meanRadiance({ width, height, data }, [left, top], [right, bottom]) {
    const weights = [0.125, 0.75, 0.125],
        sum = [0, 0, 0];
    for (let y = top; y < bottom; ++y)
        for (let x = left; x < right; ++x)
            for (let i = 0; i < 9; ++i) {
                const row = Math.min(Math.max(y + Math.floor(i / 3) - 1, 0), height - 1),
                    at = 4 * (row * width + ((x + (i % 3) - 1 + width) % width));
                for (let c = 0; c < 3; ++c) sum[c] += weights[i % 3] * weights[Math.floor(i / 3)] * data[at + c];
            }
    return sum.map((of) => of / ((right - left) * (bottom - top)));
}

// { points, pointRadiance }, four numbers each: the middles of cells that are chosen systematically, with their density, 1/sr,
// and the mean radiance of the cells.
function skyPoints({ columns, chances, densities }, image, cellTexels) {
    const points = [],
        pointRadiance = [],
        { width, height } = image;
    let sum = 0;
    chances.forEach((chance, cell) => {
        sum += chance;
        const low = [cell % columns, Math.floor(cell / columns)].map((x) => cellTexels * x),
            high = [Math.min(low[0] + cellTexels, width), Math.min(low[1] + cellTexels, height)],
            azimuth = Math.PI * ((low[0] + high[0]) / width - 1),
            polar = (Math.PI * (low[1] + high[1])) / (2 * height),
            across = Math.sin(polar);
        while (points.length < 4 * kSkyPoints && points.length / 4 + 0.5 <= sum * kSkyPoints) {
            const density = densities[low[1] * width + low[0]];
            points.push(across * Math.cos(azimuth), Math.cos(polar), across * Math.sin(azimuth), density);
            pointRadiance.push(...meanRadiance(image, low, high), 0);
        }
    });
    return { points, pointRadiance };
}

// Row 0 at +Y, as shaders/lib/environment.glsl has it; three.js has it at -Y.
function turnedOver({ width, height, data }) {
    const rows = new Float32Array(data.length);
    for (let y = 0; y < height; ++y)
        rows.set(data.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
    return { width, height, data: rows };
}

// { picture, choices, columns, rows, cellTexels, points, pointRadiance }; `choices` is null where nothing is sampled. `environment`: a texture of
// three.js, or none.
export function uploadEnvironment(gl, environment) {
    const black = { width: 1, height: 1, data: new Float32Array(4) },
        image = turnedOver(environment?.image ?? black),
        { width, height, data } = image;
    let cellTexels = 1;
    while (Math.ceil(width / cellTexels) * Math.ceil(height / cellTexels) > kMaxCells) cellTexels *= 2;
    const chances = chancesOf(image, cellTexels),
        texels = data.map((x, i) => Math.min(i % 4 === 3 ? Math.sqrt(chances.densities[(i - 3) / 4]) : x, kMaxRadiance));
    const picture = createTexture2D(gl, gl.RGBA16F, width, height, texels);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.REPEAT);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
        gl.texParameteri(gl.TEXTURE_2D, filter, gl.LINEAR);
    const { columns, rows } = chances,
        choices = chances.chances ? createTable(gl, gl.RGBA32UI, choiceEntries(chances)) : null;
    return { picture, choices, columns, rows, cellTexels, ...(choices ? skyPoints(chances, image, cellTexels) : {}) };
}
