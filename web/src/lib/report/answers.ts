// Responds to the page's requests from the data of a report, as the server does.

import { ApiError, type Source } from '../api';
import type { ApiRoot, Asked, Cases, RunList, Signal, Snapshot } from '../api-types';
import { LIST_NAMES, type ListName } from '../record/detail';
import { present } from '../present';
import type { Data } from './embedded';

interface Overview {
    format: number;
    run: string;
    snapshot: Snapshot;
    /** The chunk of each key. */
    places: Record<string, number>;
}

type Lists = { [list in ListName]?: unknown[] };

/** The details of one attempt of a test, start of a fixture or run of a hook. */
interface Details extends Lists {
    series?: Signal[];
    questions?: Asked[];
    cases?: Cases;
    omitted?: { [list in ListName]?: number };
}

/** The format of the data that this page reads. */
const FORMAT = 1;

export class Answers {
    private constructor(
        private readonly data: Data,
        private readonly overview: Overview,
    ) {}

    static async open(data: Data): Promise<Answers> {
        const overview = await data.readBlock<Overview>('overview');
        if (overview.format !== FORMAT) throw new Error(`unknown format ${overview.format}`);
        return new Answers(data, overview);
    }

    readonly get: Source = async (path) => {
        const [route = '', search = ''] = path.split('?');
        const parts = route.split('/').slice(1).map(decodeURIComponent);
        const query = new URLSearchParams(search);
        const [, run, ...rest] = parts;
        if (run === undefined) return parts.length === 0 ? this.root() : this.runs();
        if (run !== this.overview.run)
            throw new ApiError(404, `this report has only the run ${this.overview.run}`);
        const answer = await this.part(rest, query);
        if (answer === undefined) throw new ApiError(404, 'this report does not have this part');
        return answer;
    };

    private root(): ApiRoot {
        const { run, snapshot } = this.overview;
        return {
            api: 1,
            rtf: snapshot.info.rtf,
            mode: 'report',
            current: run,
            control: false,
            rerun: false,
            authorised: false,
            token_to_read: false,
            seconds: Date.now() / 1000,
        };
    }

    private runs(): RunList {
        return { runs: [this.overview.snapshot.info] };
    }

    private async part(parts: string[], query: URLSearchParams): Promise<unknown> {
        const [kind, id, , number, list] = parts;
        if (kind === 'snapshot') return this.overview.snapshot;
        if (id === undefined) return kind === 'tests' ? this.testsWith(query) : undefined;
        if (number === undefined) return this.entry(`${kind}/${id}`);
        const details = (await this.entry<Details>(`${kind}/${id}/${number}`)) ?? {};
        switch (list) {
            case 'series':
                return { series: (details.series ?? []).map((signal) => part(signal, query)) };
            case 'questions':
                return { questions: details.questions ?? [] };
            case 'cases':
                return details.cases ?? { cases: [] };
            default:
                return listOf(details, list);
        }
    }

    /** The value of a key. */
    private async entry<T>(key: string): Promise<T | undefined> {
        const chunk = this.overview.places[key];
        if (chunk === undefined) return undefined;
        return (await this.data.readBlock<Record<string, T>>(String(chunk)))[key];
    }

    /** The tests with a case whose path contains these words. */
    private async testsWith(query: URLSearchParams): Promise<Pick<Snapshot, 'tests'>> {
        const words = (query.get('case') ?? '').toLowerCase().split(/\s+/);
        const tests = [];
        for (const test of this.overview.snapshot.tests) {
            for (const { number } of test.attempts) {
                const details = await this.entry<Details>(`tests/${test.id}/${number}`);
                const paths = details?.cases?.cases.map(({ path }) => path.toLowerCase()) ?? [];
                if (!paths.some((path) => words.every((word) => path.includes(word)))) continue;
                tests.push(test);
                break;
            }
        }
        return { tests };
    }
}

function listOf(details: Details, name: string | undefined): unknown {
    const list = LIST_NAMES.find((known) => known === name);
    if (list === undefined) return undefined;
    return { [list]: details[list] ?? [], ...present({ omitted: details.omitted?.[list] }) };
}

/** The points of a signal in the window of the query. */
function part(signal: Signal, query: URLSearchParams): Signal {
    const from = Number(query.get('from') ?? -Infinity);
    const to = Number(query.get('to') ?? Infinity);
    const isIn = signal.times.map((time) => time >= from && time <= to);
    return {
        ...signal,
        times: signal.times.filter((_, index) => isIn[index]),
        values: signal.values.filter((_, index) => isIn[index]),
    };
}
