// The session with the server: its mode, and whether this
// browser may control it.

import * as api from './api';
import type { ApiRoot } from './api-types';
import { messageOf } from './task.svelte';

class Session {
    root: ApiRoot | null = $state.raw(null);
    /** Why the server cannot be reached. */
    problem: string | null = $state(null);
    /** Whether the server has refused this browser's token. */
    hasLostToken = $state(false);
    /** Whether the server does not respond. */
    isGone = $state(false);

    /** Whether this browser has the token's permissions. */
    get mayControl(): boolean {
        return this.root !== null && this.root.control && this.root.authorised;
    }

    /** Whether this browser may rerun failed tests. */
    get mayRerun(): boolean {
        return this.mayControl && this.root?.rerun === true;
    }

    /** Whether this browser may stop this run. */
    mayStop(run: string): boolean {
        return this.mayControl && this.root?.controlled === run;
    }

    /** Whether it may stop single tests and suites of this run. */
    mayStopParts(run: string): boolean {
        return this.mayStop(run) && this.root?.mode === 'run';
    }

    /** Whether reading needs the token, too. */
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
            this.problem = messageOf(problem);
        }
    }

    /** Removes the token from the page's address. */
    async begin(): Promise<void> {
        const token = /^#token=(.+)$/.exec(location.hash)?.[1];
        if (token !== undefined) {
            history.replaceState(null, '', location.pathname + location.search);
            dispatchEvent(new HashChangeEvent('hashchange'));
            await this.signIn(decodeURIComponent(token)).catch(() => undefined);
        }
        if (this.root === null) await this.refresh();
    }

    /** Throws an `ApiError` if the token is wrong. */
    async signIn(token: string): Promise<void> {
        await api.signIn(token);
        this.hasLostToken = false;
        await this.refresh();
    }

    async signOut(): Promise<void> {
        await api.signOut();
        await this.refresh();
    }

    /** Runs an action that needs the token; after a refusal, the token is forgotten. */
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
