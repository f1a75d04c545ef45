// The suites of the browser tests.

/** An arm whose simulator is killed on its first start; each step waits for permission to continue. */
export const ARM = `<suite name="arm" tolerate-collapse="true">
  <description>An arm that loses its simulator</description>
  <fixture name="simulator" type="process" restarts="2" restart-delay="100ms">
    <command>python3 -u simulator.py</command>
    <ready log="the simulator is up"/>
    <provide name="port" log="listening on port (\\d+)"/>
  </fixture>
  <hook name="park" on="collapse end"><command>python3 -u park.py</command></hook>
  <test type="python" name="Sweep" param="sweep" after-collapse="rerun">Step</test>
  <test type="python" name="Grip" param="grip" tags="slow">Step</test>
</suite>`;

/** Tests that wait until they are stopped. */
export const WAITING = `<suite name="waiting">
  <test type="python" name="First" param="never">Step</test>
  <test type="python" name="Second" param="never">Step</test>
  <test type="python" name="Third" param="never">Step</test>
</suite>`;

/** Tests that pass, fail, have an error, crash, and measure more than once. */
export const MIXED = `<suite name="mixed">
  <description>A bit of everything</description>
  <fixture name="simulator" type="process">
    <command>python3 -u simulator.py</command>
    <ready log="the simulator is up"/>
  </fixture>
  <hook name="park" on="failure end"><command>python3 -u park.py</command></hook>
  <test type="python" name="Measures" param="through">Step</test>
  <test type="python" name="Repeats" param="through" repetition="3">Step</test>
  <test type="python" name="Fails" param="fail">Ends</test>
  <test type="python" name="Errs" param="error">Ends</test>
  <test type="python" name="Crashes" param="crash">Ends</test>
</suite>`;

/** Names and output that try to inject markup. */
export const HOSTILE = `<suite name="&lt;b&gt; &quot;quoted&quot; 'suite' &amp;amp;">
  <description>&lt;img src=x onerror=alert(1)&gt;</description>
  <test type="python" name="&lt;script&gt;alert(1)&lt;/script&gt;" tags="&lt;i&gt;tag">Hostile</test>
  <test type="python" name="größe 🤖 \u202egnp.exe" param="through">Step</test>
</suite>`;

/** Signals of many samples. */
export const SIGNALS = `<suite name="signals">
  <test type="python" name="Samples">Samples</test>
</suite>`;

/** A suite with a failure, to be rerun. */
export const BROKEN = `<suite name="broken">
  <test type="python" name="Works" param="through">Step</test>
  <test type="python" name="Breaks" param="fail">Ends</test>
</suite>`;

/** A violated monitor, a trajectory and a picture that differ from stored ones, a recording. */
export const WATCHED = `<suite name="watched">
  <signal name="level" unit="m" test="sample"/>
  <monitor name="not too high">always(level &lt; 2m)</monitor>
  <test type="python" name="Watched">Watched</test>
</suite>`;
