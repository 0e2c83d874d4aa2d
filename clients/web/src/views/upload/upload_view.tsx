import { lazyView } from '../../app/lazy_view';
import type { Route } from '../../app/routes';
import { TransferForm } from './transfer_form';
import { UploadForm } from './upload_form';

const JobProgress = lazyView(async () => (await import('./job_progress')).JobProgress);

type UploadRoute = Extract<Route, { view: 'upload' }>;

/** From a file to grasps: store it, start a transfer, watch it. */
export function UploadView({ route }: { readonly route: UploadRoute }) {
  if (route.job !== undefined) return <JobProgress key={route.job} id={route.job} />;
  if (route.object !== undefined) return <TransferForm key={route.object} object={route.object} />;
  return <UploadForm />;
}
