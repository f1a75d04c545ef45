// Who the reader is to the server: what the server is, and whether this
// browser may control it.

import * as api from './api';
import type { ApiRoot } from './api-types';

class Session {
    root: ApiRoot | null = $state.raw(null);
    /** Why the server cannot be asked, in words. */
    problem: string | null = $state(null);
    /** Whether the server has refused the token that this browser had. */
    hasLostToken = $state(false);
    /** Whether the server does not answer at all. */
    isGone = $state(false);

    /** Whether this browser may do what the token allows. */
    get mayControl(): boolean {
        return this.root !== null && this.root.control && this.root.authorised;
    }

    /** Whether failed tests can be run again here, by this browser. */
    get mayRerun(): boolean {
        return this.mayControl && this.root?.rerun === true;
    }

    /** Whether this browser may stop this run. */
    mayStop(run: string): boolean {
        return this.mayControl && this.root?.controlled === run;
    }

    /** Whether that holds for its tests and suites, one by one. */
    mayStopParts(run: string): boolean {
        return this.mayStop(run) && this.root?.mode === 'run';
    }

    /** Whether not even reading is allowed without the token. */
    get isLocked(): boolean {
        return this.root !== null && this.root.token_to_read && !this.root.authorised;
    }

    async refresh(): Promise<void> {
        try {
            this.root = await api.root();
            this.problem = null;
            this.isGone = false;
        } catch (problem) {
            this.isGone = problem instanceof api.ApiError && problem.status === 0;
            this.problem = problem instanceof Error ? problem.message : String(problem);
        }
    }

    /** Takes the token out of the page's address, and out of sight. */
    async begin(): Promise<void> {
        const token = /^#token=(.+)$/.exec(location.hash)?.[1];
        if (token !== undefined) {
            history.replaceState(null, '', location.pathname + location.search);
            dispatchEvent(new HashChangeEvent('hashchange'));
            await this.signIn(decodeURIComponent(token)).catch(() => undefined);
        }
        if (this.root === null) await this.refresh();
    }

    /** Throws an `ApiError` when the token is not the right one. */
    async signIn(token: string): Promise<void> {
        await api.signIn(token);
        this.hasLostToken = false;
        await this.refresh();
    }

    async signOut(): Promise<void> {
        await api.signOut();
        await this.refresh();
    }

    /** Does what needs the token; a refusal tells that this browser has it no longer. */
    async control<T>(act: () => Promise<T>): Promise<T> {
        try {
            return await act();
        } catch (problem) {
            if (problem instanceof api.ApiError && problem.status === 401) {
                this.hasLostToken = true;
                await this.refresh();
            }
            throw problem;
        }
    }
}

export const session = new Session();
