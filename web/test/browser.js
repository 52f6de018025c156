// A browser and a server of folders, for the tests.
import { createServer } from 'node:http';
import { readFile } from 'node:fs/promises';
import { extname, join, normalize } from 'node:path';
import { chromium } from 'playwright-core';
import { shared } from './shared.js';

// A guard against hanging: pages take seconds, software that draws them and a busy machine a minute.
const timeout = 600_000;

const types = {
    '.html': 'text/html',
    '.js': 'text/javascript',
    '.css': 'text/css',
    '.png': 'image/png',
    '.glb': 'model/gltf-binary',
};

// Serves `folder` under `prefix`, and the files that `others` names by their paths there. Returns { url, close }.
export async function serve(folder, prefix = '/', others = {}) {
    const server = createServer(async (request, response) => {
        const path = decodeURIComponent(new URL(request.url, 'http://x').pathname);
        try {
            if (!path.startsWith(prefix)) throw new Error('outside');
            const name = normalize(path.slice(prefix.length) || 'index.html');
            const bytes = await readFile(others[name] ?? join(folder, name));
            response.writeHead(200, {
                'content-type': types[extname(name)] ?? 'application/octet-stream',
                'content-length': bytes.length,
            });
            response.end(bytes);
        } catch {
            response.writeHead(404).end();
        }
    });
    await new Promise((done) => {
        server.listen(0, '127.0.0.1', done);
    });
    return { url: `http://127.0.0.1:${server.address().port}${prefix}`, close: () => server.close() };
}

// `angle`: what WebGL is drawn by, 'swiftshader' or 'gl-egl', the system's driver, which `phat render` uses, too.
export async function launch(angle = 'swiftshader') {
    const browser = await chromium.launch({
        timeout,
        executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
        args: [
            '--no-sandbox',
            '--use-gl=angle',
            `--use-angle=${angle}`,
            '--enable-unsafe-swiftshader',
            '--ignore-gpu-blocklist',
            '--disable-quic',
            '--no-first-run',
            '--disable-background-networking',
            '--disable-component-update',
            '--disable-sync',
        ],
    });
    const newPage = browser.newPage.bind(browser);
    browser.newPage = async (options) => {
        const page = await newPage(options);
        page.setDefaultTimeout(timeout);
        return page;
    };
    return browser;
}

// The same, one for all: { value, dispose }.
export const borrowBrowser = shared(launch, (browser) => browser.close());
