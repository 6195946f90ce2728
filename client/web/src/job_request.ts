// Asks for a job, once: a try of which no answer came, made again, asks for the job that may be there.
import { create, toJsonString } from "@bufbuild/protobuf";
import { CreateJobRequestSchema, JobSchema, JobState, type Job } from "../generated/tetstream/v1/jobs_pb";
import type { MeshRequest } from "../generated/tetstream/v1/meshes_pb";
import { options } from "./page";
import { unary } from "./rpc";

const kEndedInVain = [JobState.FAILED, JobState.CANCELLED, JobState.EXPIRED];

/** What was asked for last, unless a job came of it. */
let unanswered: { id: string; what: string } | undefined;

/** 128 random bits. `crypto.randomUUID` is not there on pages that came without TLS. */
function newId(): string {
  return [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

export async function askForJob(mesh: MeshRequest, displayName: string): Promise<Job> {
  const job = create(JobSchema, { mesh, displayName });
  const what = toJsonString(JobSchema, job);
  const isAskedAgain = unanswered?.what === what;
  const { id } = (unanswered = unanswered?.what === what ? unanswered : { id: newId(), what });
  const answer = await unary("JobService/CreateJob", CreateJobRequestSchema,
    create(CreateJobRequestSchema, { job, requestId: id }), JobSchema, options());
  unanswered = undefined;
  // The first try's job may have ended meanwhile: who asks again wants one that will be made.
  return isAskedAgain && kEndedInVain.includes(answer.state) ? askForJob(mesh, displayName) : answer;
}
