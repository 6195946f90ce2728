// A file to the server: digested, looked for, sent from where an earlier try ended.
import { create } from "@bufbuild/protobuf";
import { GetUploadStatusRequestSchema, UploadStatusSchema } from "../generated/tetstream/v1/grids_pb";
import { options } from "./page";
import { headersOf, RpcError, unary } from "./rpc";
import { Sha256 } from "./sha256";

const kPiece = 8 << 20;

/** The file's name on the server: `grids/{sha256}`. */
export async function upload(file: File, tell: (text: string) => void): Promise<string> {
  if (file.size === 0) throw new Error(`${file.name} is empty`);
  const sha256 = new Sha256();
  for (let at = 0; at < file.size; at += kPiece) {
    tell(`Reading ${file.name}: ${Math.round((100 * at) / file.size)} %`);
    sha256.add(new Uint8Array(await file.slice(at, at + kPiece).arrayBuffer()));
  }
  const name = `grids/${sha256.hex()}`;
  const status = await unary("GridService/GetUploadStatus", GetUploadStatusRequestSchema,
    create(GetUploadStatusRequestSchema, { name }), UploadStatusSchema, options());
  let { complete } = status;
  for (let at = Number(status.committedSize); !complete;) {
    tell(`Sending ${file.name}: ${Math.round((100 * at) / file.size)} %`);
    // A server that ended before it could keep what had come whole keeps it when the last byte comes again.
    const from = Math.min(at, file.size - 1), end = Math.min(from + kPiece, file.size);
    const answer = await fetch(`/v1/${name}`, {
      method: "PUT",
      headers: { ...headersOf(options(), "application/octet-stream"),
        "Content-Range": `bytes ${from}-${end - 1}/${file.size}` },
      body: file.slice(from, end),
    });
    const said = await answer.json();
    if (!answer.ok) throw new RpcError(said.error.code, said.error.message, said.error.reason, said.error.request_id);
    complete = said.complete === true;
    const committed = Number(said.committedSize);
    if (!complete && !(committed > at)) {
      throw new Error(`the server keeps ${at} of ${file.size} bytes of ${file.name} and takes no more: try again`);
    }
    at = committed;
  }
  return name;
}
