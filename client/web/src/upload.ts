// A file to the server: digested, looked for, sent from where an earlier try ended.
import { create } from "@bufbuild/protobuf";
import { GetUploadStatusRequestSchema, UploadStatusSchema } from "../generated/tetstream/v1/grids_pb";
import { options } from "./page";
import { headersOf, RpcError, unary } from "./rpc";
import { Sha256 } from "./sha256";

const kPiece = 8 << 20;

/** The file's name on the server: `grids/{sha256}`. */
export async function upload(file: File, tell: (text: string) => void): Promise<string> {
  const sha256 = new Sha256();
  for (let at = 0; at < file.size; at += kPiece) {
    tell(`Reading ${file.name}: ${Math.round((100 * at) / file.size)} %`);
    sha256.add(new Uint8Array(await file.slice(at, at + kPiece).arrayBuffer()));
  }
  const name = `grids/${sha256.hex()}`;
  const status = await unary("GridService/GetUploadStatus", GetUploadStatusRequestSchema,
    create(GetUploadStatusRequestSchema, { name }), UploadStatusSchema, options());
  if (status.complete) return name;
  for (let at = Number(status.committedSize); at < file.size;) {
    tell(`Sending ${file.name}: ${Math.round((100 * at) / file.size)} %`);
    const end = Math.min(at + kPiece, file.size);
    const answer = await fetch(`/v1/${name}`, {
      method: "PUT",
      headers: { ...headersOf(options(), "application/octet-stream"),
        "Content-Range": `bytes ${at}-${end - 1}/${file.size}` },
      body: file.slice(at, end),
    });
    const said = await answer.json();
    if (!answer.ok) throw new RpcError(said.error.code, said.error.message, said.error.reason, said.error.request_id);
    at = Number(said.committedSize);
  }
  return name;
}
