require "rtf"
require "tmpdir"

class Attach < RTF::TestCase
  def run
    Dir.mktmpdir do |folder|
      trace = File.join(folder, "trace.csv")
      File.write(trace, "t,q\n0,1\n")
      attach(trace, name: "trace.csv", media_type: "text/csv")
    end
  end
end
