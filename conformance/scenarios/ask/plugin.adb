with Ada.Streams.Stream_IO;          use Ada.Streams.Stream_IO;
with RobotTestingFramework.Asserter; use RobotTestingFramework.Asserter;
with RobotTestingFramework.Cases;    use RobotTestingFramework.Cases;
with RobotTestingFramework.Session;  use RobotTestingFramework.Session;

package body Plugin is

   procedure Ask_Number is
   begin
      Report ("answer: " & Ask ("Serial number?", Default => "SN-17"));
   end Ask_Number;

   overriding procedure Run (Self : in out Test) is
      Signature : constant String :=
        Character'Val (16#89#) & "PNG" & ASCII.CR & ASCII.LF & Character'Val (16#1A#) & ASCII.LF;
      Picture : File_Type;
   begin
      Create (Picture, Out_File, "hand.png");
      String'Write (Stream (Picture), Signature);
      Close (Picture);
      Report ("answer: "
        & Ask ("Is the hand" & ASCII.LF & "closed?", (+"yes", +"no"), 20.0, "no", "hand.png"));
      Run_Case ("serial number", Ask_Number'Access);
      Instruct ("Push the button", Timeout => 1.5, Default => "done");
      Report ("pushed");
   end Run;

end Plugin;
