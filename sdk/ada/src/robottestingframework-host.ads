--  SPDX-License-Identifier: Apache-2.0
--  The connection to the host process through the binary interface.

with RobotTestingFramework.ABI;
with System;

private package RobotTestingFramework.Host is

   --  Sets the host's table, which create() of the plug-in gets.
   procedure Connect (To : ABI.Host_Access);

   --  Raises Program_Error in a program that `rtf run` has not started.
   function Table return not null ABI.Host_Access;

   --  The same, for the functions of version 1.3: an older rtf is an error.
   function Table_Since_1_3
     (Feature : String; File : String; Line : Natural) return not null ABI.Host_Access;

   --  Sends a message; an empty file is an unknown location.
   procedure Send
     (Kind       : ABI.Message_Kind;
      Content      : String;
      File       : String;
      Line       : Natural;
      Critical   : Boolean     := False;
      Comparison : ABI.Address := System.Null_Address);

   --  Converts texts. The argument must outlive the result.
   function To_C (Content : aliased String) return ABI.Text;
   function To_Ada (Content : ABI.Text) return String;

   --  The next text of this length in a string that outlives the result.
   procedure Lend
     (Content : aliased String; Next : in out Positive; Length : Natural; Text : out ABI.Text);

   --  A number like C's %.6g, as in all SDKs (see conformance/texts.json).
   function Image (Number : Long_Float) return String;

   --  A finite number in JSON, with all its digits.
   function JSON_Image (Number : Long_Float) return String;

end RobotTestingFramework.Host;
