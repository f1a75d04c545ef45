// A network between browser and server that can be interrupted: a forward proxy
// that closes all its connections.

import http from 'node:http';

export class Network {
    sockets = new Set();
    /** All requests: their addresses and headers. */
    requests = [];
    server = http.createServer((request, response) => {
        const { hostname, port, pathname, search } = new URL(request.url);
        const { method, headers } = request;
        this.requests.push({ url: request.url, headers });
        const onward = http.request({ hostname, port, path: pathname + search, method, headers });
        onward.on('response', (answer) => {
            response.writeHead(answer.statusCode, answer.headers);
            answer.pipe(response);
        });
        onward.on('error', () => response.destroy());
        response.on('close', () => onward.destroy());
        request.pipe(onward);
    });

    static async make() {
        const network = new Network();
        network.server.on('connection', (socket) => {
            network.sockets.add(socket);
            socket.on('close', () => network.sockets.delete(socket));
        });
        await network.join(0);
        network.port = network.server.address().port;
        return network;
    }

    /** The options of a browser context that uses it. */
    get options() {
        return { proxy: { server: `http://127.0.0.1:${this.port}`, bypass: '<-loopback>' } };
    }

    async cut() {
        const closed = new Promise((resolve) => this.server.close(resolve));
        for (const socket of this.sockets) socket.destroy();
        await closed;
    }

    join(port = this.port) {
        return new Promise((resolve) => this.server.listen(port, '127.0.0.1', resolve));
    }
}
