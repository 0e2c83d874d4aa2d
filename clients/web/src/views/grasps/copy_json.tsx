import { useEffect, useRef, useState } from 'preact/hooks';

const SHOWN_FOR = 2000; // ms

/** Copies a value as JSON. Without a clipboard (a page that did not come over
 * HTTPS or from this machine has none) the text is there to be selected. */
export function CopyJson({ value }: { readonly value: object }) {
  const [state, setState] = useState<'ready' | 'copied' | 'shown'>('ready');
  const text = useRef<HTMLTextAreaElement>(null);
  const json = JSON.stringify(value, null, 2);
  useEffect(() => {
    setState('ready');
  }, [json]);
  useEffect(() => {
    if (state === 'shown') text.current?.select();
    if (state !== 'copied') return;
    const timer = setTimeout(() => { setState('ready'); }, SHOWN_FOR);
    return () => { clearTimeout(timer); };
  }, [state]);
  const copy = async (): Promise<void> => {
    try {
      await navigator.clipboard.writeText(json);
      setState('copied');
    } catch {
      setState('shown');
    }
  };
  return (
    <>
      <button type="button" class="copy" onClick={() => { void copy(); }}>
        <span aria-live="polite">{state === 'copied' ? 'Copied' : 'Copy JSON'}</span>
      </button>
      {state === 'shown' && <textarea ref={text} readOnly rows={8} aria-label="The grasp as JSON" value={json} />}
    </>
  );
}
