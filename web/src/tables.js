// The tables that the shaders read, from the file's data.
// twin: src/gl/phatexture_upload.cpp, src/gl/lookup_pass.cpp, inverseCdfOf in src/core/phatexel/lookup_tables.cpp.
import { createTexture2D, createTextureArray } from './gl.js';
import { kNoChart } from './file.js';

export const kTableWidth = 2048; // twin: shaders/lib/table.glsl
export const kTablesWide = 512; // twin: shaders/lib/lookup_tables.glsl
export const kTableSide = 16;

// Words or floats, four a texel.
export function createTable(gl, format, values) {
    const rows = Math.max(1, Math.ceil(values.length / 4 / kTableWidth)),
        padded = new values.constructor(4 * kTableWidth * rows);
    padded.set(values);
    return createTexture2D(gl, format, kTableWidth, rows, padded);
}

// The guide as it is inverted: each cell's part of the unit square, in 255ths.
export function inverseCdfOf(weights) {
    const code = (x) => Math.round(255 * x);
    const rows = new Float64Array(kTableSide);
    weights.forEach((weight, i) => {
        rows[i >> 4] += weight;
    });
    const total = rows.reduce((sum, row) => sum + row, 0);
    const cells = new Uint8Array(4 * weights.length);
    let above = 0;
    for (let y = 0; y < kTableSide; ++y) {
        let before = 0;
        for (let x = 0; x < kTableSide; ++x) {
            const weight = weights[kTableSide * y + x];
            cells.set(
                [
                    code(before / rows[y]),
                    code((before + weight) / rows[y]),
                    code(above / total),
                    code((above + rows[y]) / total),
                ],
                4 * (kTableSide * y + x),
            );
            before += weight;
        }
        above += rows[y];
    }
    return cells;
}

// A table of 16x16 entries for each guide, many side by side. twin: src/gl/guide_tables.h.
export function uploadGuideTables(gl, format, guides, tableOf) {
    const count = guides.length / 256;
    const width = Math.min(count, kTablesWide) * kTableSide,
        height = Math.ceil(count / kTablesWide) * kTableSide;
    let pixels = null;
    for (let i = 0; i < count; ++i) {
        const cells = tableOf(guides.subarray(256 * i, 256 * i + 256)),
            channels = cells.length / kTableSide ** 2;
        pixels ??= new cells.constructor(channels * width * height);
        const x = (i % kTablesWide) * kTableSide,
            y = Math.floor(i / kTablesWide) * kTableSide;
        for (let row = 0; row < kTableSide; ++row)
            pixels.set(
                cells.subarray(channels * kTableSide * row, channels * kTableSide * (row + 1)),
                channels * ((y + row) * width + x),
            );
    }
    return createTexture2D(gl, format, width, height, pixels);
}

// 16x16 levels a tile, two words a row, as 2x4 texels of 8x4 levels.
export function uploadProbes(gl, levels, tilesWide, tilesHigh) {
    const texels = new Uint32Array(levels.length),
        width = 2 * tilesWide;
    for (let i = 0; i < levels.length; ++i) {
        const tile = i >> 5,
            row = (i >> 1) & 15,
            half = i & 1;
        const x = 2 * (tile % tilesWide) + half,
            y = 4 * Math.floor(tile / tilesWide) + (row >> 2);
        texels[4 * (y * width + x) + (row & 3)] = levels[i];
    }
    return createTexture2D(gl, gl.RGBA32UI, width, 4 * tilesHigh, texels);
}

export function uploadScrambles(gl, layers, blockCount) {
    const rows = Math.max(1, Math.ceil(blockCount / kTablesWide));
    const table = new Uint16Array(rows * layers.length * kTablesWide);
    layers.forEach(({ scrambles }, layer) =>
        scrambles.forEach((scramble, block) => {
            table[
                (Math.floor(block / kTablesWide) * layers.length + layer) * kTablesWide +
                    (block % kTablesWide)
            ] = scramble;
        }),
    );
    return createTexture2D(gl, gl.R16UI, kTablesWide, rows * layers.length, table);
}

const floatBits = new Uint32Array(1),
    floatOf = new Float32Array(floatBits.buffer);
function bitsOf(x) {
    floatOf[0] = x;
    return floatBits[0];
}

function blockOfTile(chart, x, y) {
    return (
        chart.firstBlock +
        ((y - chart.originTile[1]) >> 2) * chart.blocksWide +
        ((x - chart.originTile[0]) >> 2)
    );
}

function uploadTileTable(gl, atlas, tilesWide, tilesHigh) {
    const table = new Uint32Array(4 * atlas.tileChart.length);
    atlas.tileChart.forEach((index, i) => {
        const chart = atlas.charts[index];
        if (chart)
            table.set(
                [
                    index,
                    blockOfTile(chart, i % tilesWide, Math.floor(i / tilesWide)),
                    bitsOf(chart.texelSizeMeters),
                    0,
                ],
                4 * i,
            );
        else table.set([kNoChart, kNoChart, 0, 0], 4 * i);
    });
    return createTexture2D(gl, gl.RGBA32UI, tilesWide, tilesHigh, table);
}

function uploadCharts(gl, charts) {
    const rows = Math.floor(charts.length / kTableWidth) + 1;
    const table = new Uint32Array(4 * rows * kTableWidth);
    charts.forEach((chart, i) =>
        table.set(
            [
                ((chart.originTile[1] << 16) | chart.originTile[0]) >>> 0,
                ((chart.sizeTiles[1] << 16) | chart.sizeTiles[0]) >>> 0,
                chart.firstBlock,
                bitsOf(chart.texelSizeMeters),
            ],
            4 * i,
        ),
    );
    return createTexture2D(gl, gl.RGBA32UI, kTableWidth, rows, table);
}

function uploadTileLight(gl, radianceBound, tilesWide, tilesHigh) {
    const texels = new Float32Array((radianceBound.length / 3) * 4);
    for (let i = 0; i < radianceBound.length / 3; ++i)
        texels.set(radianceBound.subarray(3 * i, 3 * i + 3), 4 * i);
    return createTexture2D(gl, gl.RGBA32F, tilesWide, tilesHigh, texels);
}

// Textures that do not depend on the PHATexels.
export function uploadAtlas(gl, atlas) {
    const tilesWide = atlas.width / 8,
        tilesHigh = atlas.height / 8;
    const irradiance = atlas.areaIrradiance
        ? [atlas.indirectIrradiance, atlas.areaIrradiance]
        : [atlas.indirectIrradiance];
    return {
        tileTable: uploadTileTable(gl, atlas, tilesWide, tilesHigh),
        tilePatches: createTexture2D(gl, gl.RGBA32UI, 2 * tilesWide, tilesHigh, atlas.tilePatches),
        charts: uploadCharts(gl, atlas.charts),
        tileLight: uploadTileLight(gl, atlas.radianceBound, tilesWide, tilesHigh),
        irradiance: createTextureArray(gl, gl.RGB9_E5, atlas.width, atlas.height, irradiance),
    };
}
