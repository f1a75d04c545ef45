/** Takes the step of a pressed key, without modifier keys. */
export function takeStep(event: KeyboardEvent, steps: Record<string, () => void>): void {
    const step = steps[event.key];
    if (step === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    step();
}
