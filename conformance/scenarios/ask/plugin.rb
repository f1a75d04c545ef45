require "rtf"
require "tmpdir"

class Ask < RTF::TestCase
  def run
    Dir.mktmpdir do |folder|
      picture = File.join(folder, "hand.png")
      File.binwrite(picture, "\x89PNG\r\n\x1A\n".b)
      answer = ask("Is the hand\nclosed?", %w[yes no], timeout: 20, default: "no", picture: picture)
      report("answer: #{answer}")
    end
    self.case("serial number") { report("answer: #{ask("Serial number?", default: "SN-17")}") }
    instruct("Push the button", timeout: 1.5, default: "done")
    report("pushed")
  end
end
