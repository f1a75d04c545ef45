# frozen_string_literal: true

module RTF
  # The host process of Ruby plug-ins: `ruby -e 'require "rtf/host"; RTF::Host.main' --`.
  #
  # It speaks the protocol of spec/protocol.md and runs in the interpreter that
  # the user calls `ruby`, so that what can be required in their shell can be
  # required in their plug-ins.
  module Host
    module_function

    # Serves the runner, or checks files with `--check FILE…`. Ends the process
    # only when that went wrong.
    def main(arguments = ARGV)
      # Only one of the two is needed.
      if arguments.first == "--check"
        require "rtf/host/check"
        Check.files(arguments.drop(1))
      elsif arguments.any?
        warn "usage: ruby -e 'require \"rtf/host\"; RTF::Host.main' -- [--check FILE...]"
        exit 2
      else
        require "rtf/host/serve"
        status = Serve.serve
        exit status unless status.zero?
      end
    end
  end
end
