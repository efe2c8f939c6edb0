// Renders formulas by KaTeX: node formulas.js KATEX <INPUT >OUTPUT, with INPUT a list [{tex, display}] and OUTPUT a list
// of HTML, both as JSON. A formula that KaTeX does not read is an error.
const {readFileSync} = require('node:fs');

const katex = require(process.argv[2]);
const formulas = JSON.parse(readFileSync(0, 'utf8'));
const rendered = formulas.map(({tex, display}) => katex.renderToString(tex, {displayMode: display, strict: 'error'}));
process.stdout.write(JSON.stringify(rendered));
