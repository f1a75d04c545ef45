// The page as a report in one file: with the run's data, and without a server.

import { mount } from 'svelte';
import type { CampaignReport } from './generated/api';
import CampaignApp from './components/CampaignApp.svelte';
import App from './components/App.svelte';
import { readFrom } from './lib/api';
import { messageOf } from './lib/task.svelte';
import { Answers } from './lib/report/answers';
import { EmbeddedData } from './lib/report/embedded';
import './styles/base.css';
import './styles/ansi.css';

const target = document.getElementById('app');
if (target !== null) void start(target);

async function start(target: HTMLElement): Promise<void> {
    try {
        const data = new EmbeddedData(document);
        const { campaign } = await data.readBlock<{ campaign?: CampaignReport }>('overview');
        if (campaign !== undefined) {
            target.replaceChildren();
            mount(CampaignApp, { target, props: { campaign } });
            return;
        }
        const answers = await Answers.open(data);
        readFrom((path) => answers.get(path));
        target.replaceChildren();
        mount(App, { target });
    } catch (problem) {
        const reason = messageOf(problem);
        target.textContent = `This report cannot be read, the file may be damaged: ${reason}`;
    }
}
