// The page's first picture does not wait until all of its programs are compiled.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { maeOverMean, meanOf } from './room.js';
import { loaded, open, openRoom, pixelsOf, rest } from './site.js';

let browser, server, close;

before(async () => {
    ({ browser, server, close } = await openRoom());
});
after(() => close?.());

// In the page: a browser that has compiled the programs whose sources hold `globalThis.held` only when that is null;
// whoever asks for the result before would have to wait, which is noted.
function holdPrograms() {
    const kCompletionStatus = 0x91b1,
        prototype = WebGL2RenderingContext.prototype,
        { attachShader, getExtension, getProgramParameter } = prototype,
        sources = new WeakMap();
    globalThis.held = ['LobeSums', 'ScalarLobe'];
    globalThis.waited = [];
    const isHeld = (program) => globalThis.held?.some((text) => sources.get(program)?.includes(text));
    prototype.attachShader = function (program, shader) {
        sources.set(program, (sources.get(program) ?? '') + this.getShaderSource(shader));
        return attachShader.call(this, program, shader);
    };
    prototype.getExtension = function (name) {
        if (name === 'KHR_parallel_shader_compile') return { COMPLETION_STATUS_KHR: kCompletionStatus };
        return getExtension.call(this, name);
    };
    prototype.getProgramParameter = function (program, what) {
        if (what === kCompletionStatus) return !isHeld(program);
        if (isHeld(program)) globalThis.waited.push(sources.get(program).slice(0, 200));
        return getProgramParameter.call(this, program, what);
    };
}

// Of the last picture that the page drew by itself. Between two frames there may be none, when the view has come to rest.
const shownBy = async (page) => {
    const values = await page.waitForFunction(() => viewer.picture.samples > 0 && [...viewer.picture.read()]);
    return Float32Array.from(await values.jsonValue());
};

test('the first picture is there before the lookup is compiled, and the last one is the same', async () => {
    const page = await open(browser, server.url, { prepare: holdPrograms });
    await page.waitForFunction(() => globalThis.viewer?.picture.samples > 0);
    await loaded(page);
    // Pictures with all the data, but without the programs for them.
    await page.waitForFunction(() => viewer.light.progress === 1 && viewer.picture.samples === 1);
    assert.deepEqual(await page.evaluate(() => globalThis.waited), []);
    assert.equal(await page.evaluate(() => viewer.light.isWhole), false);
    const first = await shownBy(page);
    assert.ok(meanOf(first) > 0.01, `${meanOf(first)}`);
    await page.evaluate(() => {
        globalThis.held = null;
    });
    await page.waitForFunction(() => viewer.light.isWhole && viewer.secondsPerPixel > 0);
    await rest(page);
    const last = await pixelsOf(page);
    assert.deepEqual(page.problems, []);
    await page.close();

    const other = await loaded(await open(browser, server.url));
    await rest(other);
    const expected = await pixelsOf(other);
    assert.ok(maeOverMean(last, expected) < 1e-6, `${maeOverMean(last, expected)}`);
    await other.close();
});

test('each picture shows more: base colours, then all but reflections, then everything', async () => {
    const page = await open(browser, server.url, { prepare: holdPrograms });
    await page.waitForFunction(() => globalThis.viewer?.picture.samples > 0);
    await loaded(page);
    await rest(page);
    const drawn = () =>
        page.evaluate(() => {
            viewer.setScale(1);
            viewer.changed();
            viewer.addSample('fast', 1);
            return [...viewer.picture.read()];
        });
    const preview = await drawn();
    await page.evaluate(() => {
        globalThis.held = ['ScalarLobe']; // lookup.frag alone
    });
    const diffuse = await drawn();
    assert.equal(await page.evaluate(() => viewer.light.isWhole), false);
    assert.deepEqual(await page.evaluate(() => globalThis.waited), []);
    await page.evaluate(() => {
        globalThis.held = null;
    });
    const whole = await drawn();
    assert.equal(await page.evaluate(() => viewer.light.isWhole), true);
    const errors = [preview, diffuse].map((pixels) => maeOverMean(pixels, whole));
    assert.ok(errors[1] > 0.01 && errors[0] > 0.01, errors.join());
    assert.ok(maeOverMean(preview, diffuse) > 0.01, `${maeOverMean(preview, diffuse)}`);
    await page.close();
});
