// Numbers and times for display.

/** A duration in microseconds: `0.8 ms`, `12.3 s`, `4 min 05 s`, `2 h 03 min`. */
export function duration(micros: number): string {
    const ms = micros / 1000;
    if (ms < 10) return `${ms.toFixed(1)} ms`;
    if (ms < 1000) return `${Math.round(ms)} ms`;
    const seconds = ms / 1000;
    if (seconds < 60) return `${seconds.toFixed(seconds < 9.95 ? 2 : 1)} s`;
    return clock(seconds);
}

/** A duration that changes every second: `12 s`, `4 min 05 s`. */
export function clock(seconds: number): string {
    const whole = Math.max(0, Math.round(seconds));
    const two = (number: number) => String(number).padStart(2, '0');
    if (whole < 60) return `${whole} s`;
    const minutes = Math.floor(whole / 60);
    if (minutes < 60) return `${minutes} min ${two(whole % 60)} s`;
    return `${Math.floor(minutes / 60)} h ${two(minutes % 60)} min`;
}

/** A moment of the run: `+12.345 s`. */
export function moment(micros: number): string {
    return `+${(micros / 1e6).toFixed(3)} s`;
}

/** The p value of a test: `p = 0.0020`, `p < 0.0001`. */
export function pValue(p: number): string {
    return p < 0.0001 ? 'p < 0.0001' : `p = ${p.toFixed(4)}`;
}

/** A number in full precision. */
export function number(value: number): string {
    if (value === 0) return '0';
    const size = Math.abs(value);
    if (size < 1e-5 || size >= 1e15) return value.toExponential();
    return String(value);
}

/** A number with six digits. */
export function rounded(value: number): string {
    return number(Number(value.toPrecision(6)));
}

/** A number with four digits, for an axis or a difference. */
export function short(value: number): string {
    return number(Number(value.toPrecision(4)));
}

/**
 * Labels for an axis, whose values are `step` apart: with as many digits as are needed to
 * tell them apart.
 */
export function axisLabels(values: readonly number[], step: number): string[] {
    const largest = Math.max(0, ...values.map(Math.abs));
    if (!(step > 0) || largest === 0) return values.map(short);
    if (largest < 1e6 && step >= 1e-6) {
        const decimals = Math.min(9, Math.max(0, Math.ceil(-Math.log10(step) - 1e-9)));
        // A step of 0.25 needs two decimals, one of 0.2 needs one.
        const exact = [decimals, decimals + 1, decimals + 2].find(
            (each) => Math.abs(Number(step.toFixed(each)) - step) < step * 1e-6,
        );
        return values.map((value) =>
            value.toFixed(exact ?? decimals).replace(/^-(0(\.0*)?)$/, '$1'),
        );
    }
    const digits = Math.min(15, Math.max(1, Math.ceil(Math.log10(largest / step)) + 1));
    return values.map((value) => number(Number(value.toPrecision(digits))));
}

/** A count with its noun: `1 test`, `12 000 tests`. */
export function count(amount: number, one: string, many = `${one}s`): string {
    return `${grouped(amount)} ${amount === 1 ? one : many}`;
}

/** A whole number in groups of three, from five digits on. */
export function grouped(amount: number): string {
    const digits = String(amount);
    return digits.length < 5 ? digits : digits.replace(/\B(?=(\d{3})+$)/g, '\u202f');
}

/** An RFC 3339 time in the user's time zone: `2026-11-21 07:30:12`. */
export function timeOfDay(text: string): string {
    const time = new Date(text);
    if (Number.isNaN(time.getTime())) return text;
    const two = (value: number) => String(value).padStart(2, '0');
    const day = [time.getFullYear(), two(time.getMonth() + 1), two(time.getDate())].join('-');
    return `${day} ${[time.getHours(), time.getMinutes(), time.getSeconds()].map(two).join(':')}`;
}

/** A line of a file: `arm.lua:3`. */
export function place({ file, line }: { file: string; line?: number | null }): string {
    return line ? `${file}:${line}` : file;
}

/** The limits of a value: `95 … 105`, `≥ 0.5`, `≤ 2`; empty without limits. */
export function limits(low: number | null | undefined, high: number | null | undefined): string {
    if (low != null && high != null) return `${number(low)} … ${number(high)}`;
    if (low != null) return `≥ ${number(low)}`;
    if (high != null) return `≤ ${number(high)}`;
    return '';
}
