// Events of runs that would take long to make, or that depend on files.

const START = (run, tests) => [
    {
        type: 'run-started',
        version: 1,
        run,
        rtf: '0.1.0',
        started_at: '2026-11-21T07:30:12.250+01:00',
        command: ['rtf', 'run', 'arm.xml'],
        working_dir: '/home/robot/arm',
        suites: 1,
        tests,
    },
    {
        type: 'suite-planned',
        suite: 0,
        name: 'arm',
        file: 'arm.xml',
        description: '',
        environment: '',
    },
];

const END = [{ type: 'suite-finished', suite: 0 }, { type: 'run-finished' }];

function planned(test, name) {
    return {
        type: 'test-planned',
        test,
        suite: 0,
        name,
        plugin_type: 'python',
        plugin: '/home/robot/arm/arm.py',
        repetitions: 1,
    };
}

/** An attempt that passes with these details. */
function attempt(test, details) {
    return [
        { type: 'test-started', test, repetition: 1, attempt: 1 },
        { type: 'test-phase', test, phase: 'setup' },
        { type: 'test-phase', test, phase: 'run' },
        ...details,
        { type: 'test-finished', test, verdict: 'passed', phase: 'run', exit: { code: 0 } },
    ];
}

/** A run of one test, `Only`, with a message and these details. */
export function oneTest(run, details) {
    const message = { kind: 'report', text: 'a message' };
    return [
        ...START(run, 1),
        planned(0, 'Only'),
        { type: 'suite-started', suite: 0 },
        ...attempt(0, [{ type: 'message', source: { test: 0 }, message }, ...details]),
        ...END,
    ];
}

const SAMPLES = 500;

/** Samples of a sine with noise, which compresses badly. */
function sampled(test, name) {
    const points = Array.from({ length: SAMPLES }, (_, index) => {
        const noise = Math.sin(index * 12.9898 + test * 78.233) * 43758.5453;
        return [index * 0.01, Math.sin(index / 50) + (noise - Math.floor(noise)) / 100];
    });
    return { type: 'sampled', test, samples: { name, unit: 'rad', high: 1.5, points } };
}

/** A run of many tests with two signals each. */
export function manyTests(run, count) {
    const ids = Array.from({ length: count }, (_, id) => id);
    return [
        ...START(run, count),
        ...ids.map((id) => planned(id, `Test${String(id).padStart(4, '0')}`)),
        { type: 'suite-started', suite: 0 },
        ...ids.flatMap((id) => attempt(id, [sampled(id, 'elbow'), sampled(id, 'wrist')])),
        ...END,
    ];
}
