/** The contract's schemas under short names. */
import type { components, operations } from './schema';

type Schemas = components['schemas'];

export type Category = Schemas['Category'];
export type StoredObject = Schemas['Object'];
export type Part = Schemas['Part'];
export type Pose = Schemas['Pose'];
export type Point = Schemas['Point'];
export type Grasp = Schemas['Grasp'];
export type Contact = Schemas['Contact'];
export type GraspStage = Schemas['GraspStage'];
export type GraspSpace = Schemas['GraspSpace'];
export type Hand = Schemas['Hand'];
export type JointPositions = Schemas['JointPositions'];
export type Job = Schemas['Job'];
export type Outcome = Schemas['Outcome'];
export type Problem = Schemas['Problem'];
export type SettingValues = Schemas['SettingValues'];
export type Transfer = Schemas['Transfer'];
/** A transfer in a list. */
export type TransferItem = Schemas['TransferOverview'];
export type ContactMap = Transfer['contact_maps'][number];
export type Attempt = Transfer['attempts'][number];
export type Cursor = Schemas['Cursor'];
export type Parameter = Schemas['ParameterList']['items'][number];

type QueryOf<Name extends keyof operations> = NonNullable<
  operations[Name]['parameters']['query']
>;
export type GraspQuery = QueryOf<'queryGrasps'>;
export type GraspSpaceQuery = QueryOf<'listGraspSpaces'>;
export type ObjectQuery = QueryOf<'listObjects'>;
export type UploadQuery = QueryOf<'postObject'>;
export type TransferQuery = QueryOf<'postGrasps'>;
export type TransferListQuery = QueryOf<'listTransfers'>;

export interface Page<Item> {
  readonly items: readonly Item[];
  readonly next_cursor: Cursor;
}
