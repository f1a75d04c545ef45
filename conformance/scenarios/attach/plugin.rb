require "rtf"
require "tmpdir"

class Attach < RTF::TestCase
  def run
    trace = File.join(Dir.mktmpdir, "trace.csv")
    File.write(trace, "t,q\n0,1\n")
    attach(trace, name: "trace.csv", media_type: "text/csv")
  end
end
