import { render } from 'preact';

import { App } from './app/app';
import './styles/base.css';
import './styles/layout.css';
import './styles/controls.css';
import './styles/views.css';
import './styles/charts.css';

const root = document.getElementById('app');
if (!root) throw new Error('The page has no #app.');
render(<App />, root);
