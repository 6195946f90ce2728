// gRPC-Web over fetch: one message up, frames down.
import { create, fromBinary, toBinary, type DescMessage, type MessageShape } from "@bufbuild/protobuf";
import { anyUnpack } from "@bufbuild/protobuf/wkt";
import { ErrorInfoSchema } from "../generated/google/rpc/error_details_pb";
import { StatusSchema } from "../generated/google/rpc/status_pb";

/** A refusal of the server, or that it cannot be reached (then `code` is 14). */
export class RpcError extends Error {
  constructor(readonly code: number, message: string, readonly reason = "", readonly requestId = "") {
    super(message);
  }
}

export const kUnauthenticated = 16;
export const kUnavailable = 14;
export const kOutOfRange = 11;

export interface CallOptions {
  token: string;
  signal?: AbortSignal;
  timeoutMs?: number;
}

export function headersOf(options: CallOptions, type: string): Record<string, string> {
  const headers: Record<string, string> = { "Content-Type": type };
  if (options.token) headers["Authorization"] = `Bearer ${options.token}`;
  if (options.timeoutMs) headers["grpc-timeout"] = `${Math.round(options.timeoutMs)}m`;
  return headers;
}

function framed(message: Uint8Array): Uint8Array {
  const frame = new Uint8Array(5 + message.length);
  new DataView(frame.buffer).setUint32(1, message.length);
  frame.set(message, 5);
  return frame;
}

/** Cuts a stream of bytes into frames, copying each byte once. */
class Frames {
  private parts: Uint8Array[] = [];
  private size = 0;

  add(bytes: Uint8Array): void {
    this.parts.push(bytes);
    this.size += bytes.length;
  }

  next(): { flag: number; content: Uint8Array } | undefined {
    if (this.size < 5) return undefined;
    const prefix = this.peek(5);
    const length = new DataView(prefix.buffer, prefix.byteOffset).getUint32(1);
    if (this.size < 5 + length) return undefined;
    this.take(5);
    return { flag: prefix[0]!, content: this.take(length) };
  }

  private peek(count: number): Uint8Array {
    const first = this.parts[0]!;
    if (first.length >= count) return first.subarray(0, count);
    const bytes = this.take(count);
    this.parts.unshift(bytes);
    this.size += count;
    return bytes;
  }

  private take(count: number): Uint8Array {
    const taken = new Uint8Array(count);
    let at = 0;
    while (at < count) {
      const first = this.parts[0]!;
      const size = Math.min(first.length, count - at);
      taken.set(first.subarray(0, size), at);
      at += size;
      if (size === first.length) this.parts.shift();
      else this.parts[0] = first.subarray(size);
    }
    this.size -= count;
    return taken;
  }
}

function bytesOfBase64(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
}

function check(trailers: Uint8Array): void {
  const lines = new Map<string, string>();
  for (const line of new TextDecoder().decode(trailers).split("\r\n")) {
    const colon = line.indexOf(":");
    if (colon > 0) lines.set(line.slice(0, colon).toLowerCase(), line.slice(colon + 1).trim());
  }
  const code = Number(lines.get("grpc-status") ?? "2");
  if (code === 0) return;
  let reason = "";
  const details = lines.get("grpc-status-details-bin");
  if (details) {
    for (const any of fromBinary(StatusSchema, bytesOfBase64(details)).details) {
      reason = anyUnpack(any, ErrorInfoSchema)?.reason ?? reason;
    }
  }
  throw new RpcError(code, decodeURIComponent(lines.get("grpc-message") ?? ""), reason,
    lines.get("x-request-id") ?? "");
}

async function open(method: string, message: Uint8Array, options: CallOptions): Promise<Response> {
  let response: Response;
  try {
    response = await fetch(`/tetstream.v1.${method}`, {
      method: "POST",
      headers: headersOf(options, "application/grpc-web+proto"),
      body: framed(message),
      signal: options.signal,
    });
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw new RpcError(kUnavailable, "the server cannot be reached");
  }
  if (response.ok && response.body) return response;
  const said = await response.json().catch(() => ({}));
  throw new RpcError(said.error?.code ?? 2, said.error?.message ?? `HTTP ${response.status}`);
}

/** The messages of a call as bytes. The next is read when the last has been used. */
export async function* streamBytes(method: string, message: Uint8Array, options: CallOptions):
    AsyncGenerator<Uint8Array> {
  const reader = (await open(method, message, options)).body!.getReader();
  const frames = new Frames();
  try {
    for (;;) {
      let frame = frames.next();
      while (!frame) {
        const { value, done } = await read(reader, options);
        if (done) throw new RpcError(kUnavailable, "the connection broke");
        frames.add(value);
        frame = frames.next();
      }
      if (frame.flag & 0x80) return check(frame.content);
      yield frame.content;
    }
  } finally {
    void reader.cancel().catch(() => undefined);
  }
}

async function read(reader: ReadableStreamDefaultReader<Uint8Array>, options: CallOptions):
    Promise<{ value: Uint8Array; done: false } | { value?: undefined; done: true }> {
  try {
    return (await reader.read()) as never;
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw new RpcError(kUnavailable, "the connection broke");
  }
}

export async function* stream<I extends DescMessage, O extends DescMessage>(
    method: string, input: I, request: MessageShape<I>, output: O, options: CallOptions):
    AsyncGenerator<MessageShape<O>> {
  for await (const bytes of streamBytes(method, toBinary(input, request), options)) {
    yield fromBinary(output, bytes);
  }
}

export async function unary<I extends DescMessage, O extends DescMessage>(
    method: string, input: I, request: MessageShape<I>, output: O, options: CallOptions):
    Promise<MessageShape<O>> {
  let answer = create(output);
  for await (const message of stream(method, input, request, output, options)) answer = message;
  return answer;
}
