// Starts the page's first requests while its script is loaded; src/lib/api.ts takes the responses.
// As it is here in the browser: this file is not compiled.
const paths = [];
// A token in the address is for the first request.
if (!location.hash.startsWith('#token=')) {
    paths.push('/api/v1');
    // What HistoryPage requests first, without filters.
    if (/^#\/history\/?$/.test(location.hash)) {
        paths.push('/api/v1/history/matrix?after=0&limit=60');
    }
}
const started = (path) => {
    const response = fetch(path);
    // Whether it fails matters when it is taken.
    response.catch(() => undefined);
    return [path, response];
};
globalThis.rtfEarly = new Map(paths.map(started));
