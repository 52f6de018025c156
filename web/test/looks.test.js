// How the page of `phat web` looks and reads, on phones and desks, to eyes and to screen readers.
import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';
import { notes } from './house.js';
import { loaded, open, openRoom, rest } from './site.js';

const sizes = [
    [390, 844],
    [844, 390],
    [768, 1024],
    [1280, 720],
    [2560, 1440],
];
let browser, server, close, page;

before(async () => {
    ({ browser, server, close } = await openRoom('house'));
    page = await loaded(await open(browser, server.url, { size: { width: 390, height: 844 } }));
    await rest(page);
    await page.evaluate(await readFile(createRequire(import.meta.url).resolve('axe-core'), 'utf8'));
});
after(async () => {
    await page?.close();
    await close?.();
});

async function findings() {
    const { violations } = await page.evaluate(() => axe.run());
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ html, failureSummary }) => `${html} ${failureSummary}`).join('; ')}`);
}

// Of what can be touched: in sight, and its size.
const touched = () =>
    page.evaluate(() => {
        const root = document.getElementById('room').shadowRoot,
            all = [...root.querySelectorAll('button, select, input, [role=slider]'), ...document.querySelectorAll('a, button')];
        return all
            .filter((element) => element.checkVisibility({ visibilityProperty: true }))
            .map((element) => {
                const { x, y, width, height } = element.getBoundingClientRect();
                return { id: element.id || element.textContent, x, y, width, height, font: parseFloat(getComputedStyle(element).fontSize), inPanel: Boolean(element.closest('#panel, [slot=about]')) };
            });
    });

const overlap = (a, b) => a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;

for (const [width, height] of sizes)
    test(`at ${width}x${height} all can be touched and read, in the dark and in the light`, async () => {
        await page.setViewportSize({ width, height });
        for (const isOpen of [false, true]) {
            if ((await page.isVisible('#panel')) !== isOpen) await page.click(isOpen ? '#settings' : '#close');
            const all = await touched();
            assert.ok(all.length > (isOpen ? 18 : 8), `${all.length}`);
            for (const { id, x, y, width: w, height: h, font, inPanel } of all) {
                assert.ok(w >= 44 && h >= 44, `${id}: ${w} x ${h}`);
                assert.ok(font >= 16, `${id}: ${font} pixels`);
                assert.ok(x >= 0 && x + w <= width && (inPanel || (y >= 0 && y + h <= height)), `${id} at ${x}, ${y}`);
            }
            const bars = await page.$$eval('.bar', (elements) => elements.map((e) => e.getBoundingClientRect().toJSON()));
            assert.ok(!overlap(...bars), 'viewpoints and tools');
            for (const colorScheme of ['light', 'dark']) {
                await page.emulateMedia({ colorScheme });
                assert.deepEqual(await findings(), [], `${colorScheme}, settings ${isOpen ? 'open' : 'closed'}`);
            }
        }
        // The sheet leaves the room in sight.
        const { width: w, height: h } = await page.$eval('#panel', (panel) => panel.getBoundingClientRect().toJSON());
        assert.ok(w * h < 0.62 * width * height, `${w} x ${h}`);
        await page.click('#close');
    });

test('the picture says what it is and how to use it, on foot and in orbit', async () => {
    const described = () =>
        page.evaluate(() => {
            const { canvas } = viewer;
            return [canvas.getAttribute('role'), canvas.getAttribute('aria-label'), canvas.getRootNode().getElementById(canvas.getAttribute('aria-describedby')).textContent];
        });
    const [role, label, help] = await described();
    assert.equal(role, 'application');
    assert.match(label, /room/);
    assert.match(help, /tap the floor.*W A S D/);
    await page.click('#orbit');
    assert.match((await described())[2], /Drag to turn/);
    assert.equal(await page.getAttribute('#orbit', 'aria-pressed'), 'true');
    await page.click('#orbit');
    assert.equal(await page.getAttribute('#orbit', 'aria-pressed'), 'false');
});

test('notes are text, lead to web pages alone, and are hidden behind walls', async () => {
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[0]));
    const [table, hostile, away] = await page.locator('.hotspot').all();
    await table.locator('button').click();
    assert.equal(await table.locator('.note p').textContent(), notes[0].text);
    assert.deepEqual(await table.locator('a').evaluateAll((all) => all.map(({ href, rel, target }) => [href, rel, target])), [
        [notes[0].link, 'noopener noreferrer', '_blank'],
    ]);
    assert.deepEqual(await findings(), []);
    await page.keyboard.press('Escape');
    assert.ok(await table.locator('.note').isHidden());
    assert.ok(await away.locator('button').isHidden(), 'in the other room');
    await page.evaluate(() => {
        const view = viewer.cameras[0].clone();
        view.position.set(-0.6, 1.6, 0.3);
        view.rotation.set(0, Math.PI / 2, 0);
        view.updateMatrixWorld();
        viewer.navigation.goTo(view);
    });
    await hostile.locator('button').click();
    assert.equal(await hostile.locator('.note p').textContent(), notes[1].text);
    assert.equal(await hostile.locator('a, img').count(), 0);
    await page.keyboard.press('Escape');
    // A note in the other room, from there.
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[2]));
    await away.locator('button').waitFor({ state: 'visible' });
    assert.ok(await table.locator('button').isHidden());
    assert.equal(await page.evaluate(() => globalThis.hacked), undefined);
    assert.deepEqual(page.problems, []);
});

test('swatches show the variants, and which one is chosen', async () => {
    await page.click('#settings');
    const states = () => page.$$eval('#swatches button', (all) => all.map((each) => [each.textContent, each.getAttribute('aria-pressed')]));
    assert.deepEqual(await states(), [['As in the file', 'true'], ['Oak', 'false'], ['Lacquer', 'false']]);
    await page.click('#swatches button:has-text("Lacquer")');
    await page.waitForFunction(() => document.getElementById('room').find('material').textContent.includes('lacquer'));
    assert.deepEqual((await states()).map(([, pressed]) => pressed), ['false', 'false', 'true']);
    assert.match(await page.$$eval('#swatches .swatch', (all) => all[2].style.background), /srgb-linear 0\.05 0\.25 0\.1/);
    await page.click('#close');
});

test('a picture is saved, a link copied, and the whole screen filled', async () => {
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#screenshot')]);
    assert.equal(download.suggestedFilename(), 'A _table_ & more.png');
    await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
    await page.click('#share');
    await page.waitForFunction(() => document.getElementById('room').find('toast').textContent === 'The link is copied.');
    const below = await page.evaluate(() => {
        const { shadowRoot } = document.getElementById('room'),
            { left, top, width, height } = shadowRoot.getElementById('toast').getBoundingClientRect();
        return shadowRoot.elementFromPoint(left + width / 2, top + height / 2).id;
    });
    assert.equal(below, 'view', 'words do not take what is meant for the picture');
    const copied = await page.evaluate(() => navigator.clipboard.readText());
    assert.equal(copied, await page.evaluate(() => location.href));
    assert.match(copied, /#view=2\.4,1\.6,1\.5;/);
    await page.click('#fullscreen');
    await page.waitForFunction(() => document.fullscreenElement?.id === 'room');
    await page.click('#fullscreen');
    await page.waitForFunction(() => !document.fullscreenElement);
});

test('a tape measures between two taps, or by Enter, and takes no steps', async () => {
    await page.setViewportSize({ width: 1000, height: 600 });
    await page.waitForFunction(() => viewer.canvas.clientWidth === 1000 && Math.abs(viewer.camera.aspect - 10 / 6) < 1e-3);
    await page.evaluate(() => viewer.navigation.goTo(viewer.cameras[0]));
    await page.click('#measure');
    await page.waitForSelector('#tape');
    const reading = () => page.textContent('#tape output');
    assert.match(await reading(), /one end/);
    // Corners of the table top, 80 cm apart, and a bit inside.
    const places = await page.evaluate(() =>
        [-0.39, 0.39].map((z) => {
            const at = viewer.camera.position.clone().set(-1.89, 0.75, z).project(viewer.camera);
            return [((1 + at.x) / 2) * innerWidth, ((1 - at.y) / 2) * innerHeight];
        }),
    );
    const eye = await page.evaluate(() => viewer.camera.position.toArray());
    for (const [i, [x, y]] of places.entries()) {
        assert.ok(x > 0 && y > 0 && x < 1000 && y < 530, `${x}, ${y}`); // above the buttons
        await page.mouse.click(x, y);
        await page.waitForFunction((count) => document.getElementById('room').ui.tape.points.length === count, i + 1);
    }
    const meters = Number.parseFloat(await reading());
    assert.ok(Math.abs(meters - 0.78) < 0.02 && (await reading()).endsWith(' m'), await reading());
    assert.deepEqual(await page.evaluate(() => viewer.camera.position.toArray()), eye);
    await page.focus('#view');
    await page.keyboard.press('Enter');
    assert.match(await reading(), /other end/);
    await page.click('#measure');
    await page.waitForSelector('#tape', { state: 'detached' });
});

test('the border of the comparison is dragged by its handle, and covers nothing else', async () => {
    await page.setViewportSize({ width: 1280, height: 720 });
    await page.click('#settings');
    await page.check('#wipe');
    await page.click('#close');
    const partAt = (x, y) => page.evaluate((at) => document.getElementById('room').shadowRoot.elementFromPoint(...at)?.id, [x, y]);
    assert.equal(await partAt(640, 360), 'border');
    assert.equal(await partAt(640, 100), 'view');
    await page.mouse.move(640, 360);
    await page.mouse.down();
    await page.mouse.move(320, 360, { steps: 2 });
    await page.mouse.up();
    assert.equal(await page.evaluate(() => viewer.light.wipe), 0.25);
    await page.focus('#border');
    await page.keyboard.press('ArrowRight');
    assert.equal(await page.getAttribute('#border', 'aria-valuenow'), '30');
    await page.click('#settings');
    await page.uncheck('#wipe');
    assert.equal(await page.evaluate(() => viewer.light.wipe), 1);
    await page.click('#close');
});

test('link previews have a title, a description and a picture', async () => {
    const metas = await page.$$eval('meta[property], meta[name]', (all) =>
        Object.fromEntries(all.map((meta) => [meta.getAttribute('property') ?? meta.name, meta.content])),
    );
    assert.equal(metas['og:title'], 'A <table> & more');
    assert.match(metas.description, /^A <table> & more: walk through it in the browser, from 3 viewpoints\. 7 materials/);
    assert.equal(metas['og:description'], metas.description);
    assert.equal(metas['og:image'], 'poster.jpg');
});

test('speaks German where the browser does, or the address says so', async () => {
    const words = async (options, query) => {
        const context = await browser.newContext({ viewport: { width: 640, height: 360 }, ...options }),
            other = await context.newPage();
        await other.goto(`${server.url}${query}`);
        await loaded(other);
        const read = await other.evaluate(() => [
            document.documentElement.lang,
            document.getElementById('room').find('settings').title,
            viewer.canvas.getAttribute('aria-label'),
        ]);
        await context.close();
        return read;
    };
    assert.deepEqual(await words({ locale: 'de-AT' }, ''), ['de', 'Einstellungen', 'Der Raum, räumlich dargestellt']);
    assert.deepEqual(await words({ locale: 'de-AT' }, '?lang=en'), ['en', 'Settings', 'The room, seen in three dimensions']);
});

test('all languages have the same strings', async () => {
    const [english, german] = await Promise.all(['en', 'de'].map(async (name) => (await import(`../viewer/strings/${name}.js`)).default));
    assert.deepEqual(Object.keys(german), Object.keys(english));
    const blanks = (text) => [...text.matchAll(/\{\w+\}/g)].map(([blank]) => blank).sort();
    for (const [name, text] of Object.entries(english)) assert.deepEqual(blanks(german[name]), blanks(text), name);
});
