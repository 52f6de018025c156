// All tests in one process, so that they share the browsers and the baked rooms. Each file runs alone, too.
import './bundle.test.js';
import './bvh.test.js';
import './compositions.test.js';
import './failures.test.js';
import './lights.test.js';
import './moves.test.js';
import './package.test.js';
import './pictures.test.js';
import './plugin.test.js';
import './programs.test.js';
import './projects.test.js';
import './ray_tables.test.js';
import './rays.test.js';
import './rooms.test.js';
import './site.test.js';
import './site_folder.test.js';
