import type { Route } from '../../app/routes';
import { JobProgress } from './job_progress';
import { TransferForm } from './transfer_form';
import { UploadForm } from './upload_form';

type UploadRoute = Extract<Route, { view: 'upload' }>;

/** From a file to grasps: store it, start a transfer, watch it. */
export function UploadView({ route }: { readonly route: UploadRoute }) {
  if (route.job !== undefined) return <JobProgress key={route.job} id={route.job} />;
  if (route.object !== undefined) return <TransferForm key={route.object} object={route.object} />;
  return <UploadForm />;
}
