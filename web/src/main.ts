import { mount } from 'svelte';
import App from './components/App.svelte';
import './styles/base.css';
import './styles/ansi.css';

const target = document.getElementById('app');
if (target !== null) mount(App, { target });
