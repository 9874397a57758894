// The calls of the server, and what is done while it does not answer.

const banner = () => document.getElementById('lost');
let isLost = false;
let whenBack = () => {};

/** A call failed; `error` has the server's message, and the group and key that it names. */
export class Failure extends Error {
  constructor(error) {
    super(error.message);
    this.error = error;
  }
}

/** Calls `back` each time the server answers again. */
export function onReturn(back) { whenBack = back; }

function lost() {
  if (isLost) return;
  isLost = true;
  banner().textContent = 'The panel’s server does not answer. Start “gearsweep panel” again: this page then goes on by itself, and nothing that you typed is lost.';
  banner().hidden = false;
  const again = setInterval(async () => {
    try {
      await fetch('/static/icon.svg', { cache: 'no-store' });
    } catch { return; }
    clearInterval(again);
    isLost = false;
    banner().hidden = true;
    whenBack();
  }, 1000);
}

async function post(name, asked) {
  try {
    return await fetch(`/call/${name}`, { method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(asked) });
  } catch {
    lost();
    throw new Failure({ message: 'the server does not answer', code: 'LOST' });
  }
}

/** One call; what it answers. */
export async function call(name, asked = {}) {
  const answer = await post(name, asked), words = await answer.json();
  if (!answer.ok) throw new Failure(words.error);
  return words;
}

/** A run; `progress` gets the numbers of finished and of all points. */
export async function run(asked, progress) {
  const reader = (await post('run', asked)).body.getReader();
  const decoder = new TextDecoder();
  let rest = '';
  for (;;) {
    let part;
    try {
      part = await reader.read();
    } catch {
      lost();
      throw new Failure({ message: 'the server does not answer', code: 'LOST' });
    }
    rest += decoder.decode(part.value, { stream: !part.done });
    const lines = rest.split('\n');
    rest = lines.pop();
    for (const line of lines) {
      const words = JSON.parse(line);
      if (words.error) throw new Failure(words.error);
      if (words.result) return words.result;
      progress?.(words.done, words.of);
    }
    if (part.done) {
      lost();
      throw new Failure({ message: 'the server ended during the run', code: 'LOST' });
    }
  }
}
