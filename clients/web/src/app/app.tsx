import { useEffect } from 'preact/hooks';

import { BrowseView } from '../views/browse/browse_view';
import { InsightView } from '../views/insight/insight_view';
import { UploadView } from '../views/upload/upload_view';
import { Footer } from './footer';
import { lazyView } from './lazy_view';
import { Link, useRoute } from './navigation';
import type { Route } from './routes';

const GraspsView = lazyView(async () => (await import('../views/grasps/grasps_view')).GraspsView);
const ObjectView = lazyView(async () => (await import('../views/object/object_view')).ObjectView);

const SECTIONS: readonly (readonly [title: string, route: Route])[] = [
  ['Browse', { view: 'browse' }],
  ['Grasps', { view: 'grasps', filters: { stage: 'assembly', sort: 'merit' } }],
  ['Upload', { view: 'upload' }],
  ['Insight', { view: 'insight' }],
];

const TITLES: Readonly<Record<Route['view'], string>> = {
  browse: 'Browse',
  object: 'Object',
  grasps: 'Grasps',
  upload: 'Upload',
  insight: 'Insight',
};

function CurrentView({ route }: { readonly route: Route }) {
  switch (route.view) {
    case 'browse':
      return <BrowseView route={route} />;
    case 'object':
      return <ObjectView key={route.object} id={route.object} />;
    case 'grasps':
      return <GraspsView route={route} />;
    case 'upload':
      return <UploadView route={route} />;
    case 'insight':
      return <InsightView route={route} />;
  }
}

export function App() {
  const route = useRoute();
  useEffect(() => {
    document.title = `${TITLES[route.view]} · graspdb`;
  }, [route.view]);
  return (
    <>
      <a class="skip" href="#main">
        Skip to content
      </a>
      <header class="masthead">
        <Link to={{ view: 'browse' }} class="brand">
          graspdb
        </Link>
        <nav aria-label="Sections">
          {SECTIONS.map(([title, to]) => (
            <Link key={title} to={to} current={to.view === route.view}>
              {title}
            </Link>
          ))}
        </nav>
      </header>
      <main id="main" tabIndex={-1}>
        <CurrentView route={route} />
      </main>
      {route.view === 'browse' && <Footer />}
    </>
  );
}
