// Queries the search of the built guide, with mdBook's own index and search library.
//
//   node search_guide.mjs HTML <TERMS     TERMS: a JSON array of texts
//
// Prints those that are not in any of the results which a reader would get, as JSON. The search
// ignores English words such as `for` and `on`; they are searched for with a second word.

import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import vm from "node:vm";

const html = process.argv[2];
const files = readdirSync(html);
const only = (pattern) => {
  const found = files.filter((name) => pattern.test(name));
  if (found.length !== 1) throw new Error(`${found.length} files match ${pattern}`);
  return readFileSync(join(html, found[0]), "utf8");
};

const context = vm.createContext({});
vm.runInContext("var window = globalThis; var search = {};", context);
vm.runInContext(only(/^elasticlunr(-[0-9a-f]+)?\.min\.js$/), context);
vm.runInContext(only(/^searchindex(-[0-9a-f]+)?\.js$/), context);
vm.runInContext("var index = elasticlunr.Index.load(search.index);", context);

// As in mdBook's searcher.js: at most `limit_results` results.
const { search } = context;
const results = (query) =>
  vm
    .runInContext(`index.search(${JSON.stringify(query)}, search.search_options)`, context)
    .slice(0, search.results_options.limit_results);

// A result is good if its text contains the query, not only words that are similar to it.
const contains = ({ doc }, term) =>
  `${doc.breadcrumbs} ${doc.title} ${doc.body}`.toLowerCase().replace(/[`\s]+/g, " ").includes(term.toLowerCase());
const words = (term) => term.split(/[^a-z]+/i).filter(Boolean);
const isIgnored = (term) =>
  words(term).every((word) => vm.runInContext("elasticlunr", context).stopWordFilter.stopWords[word]);
const query = (term) => (isIgnored(term) ? `${term} ${term.startsWith("-") ? "rtf run" : "attribute"}` : term);
const terms = JSON.parse(readFileSync(0, "utf8"));
const lost = terms.filter((term) => !results(query(term)).some((result) => contains(result, term)));
console.log(JSON.stringify(lost));
